#include "Modules/ModuleManager.h"

// The entry point by which Unreal loads the plugin. The module does nothing when it is loaded or unloaded.
IMPLEMENT_MODULE(FDefaultModuleImpl, OsteonCutting)
