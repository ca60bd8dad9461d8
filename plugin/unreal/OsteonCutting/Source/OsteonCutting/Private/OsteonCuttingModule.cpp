#include "Modules/ModuleManager.h"

// The entry point by which Unreal loads the plugin; nothing is done at its start or end.
IMPLEMENT_MODULE(FDefaultModuleImpl, OsteonCutting)
