#pragma once

// Unreal's registration of a module. Tests call the function that the macro makes.

class FDefaultModuleImpl {};
#define IMPLEMENT_MODULE(Implementation, Name) \
  const void* Name##ModuleIsImplemented() {    \
    static Implementation module;              \
    return &module;                            \
  }
