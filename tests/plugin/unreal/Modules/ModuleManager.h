#pragma once

class FDefaultModuleImpl {};
#define IMPLEMENT_MODULE(Implementation, Name) \
  const void* Name##ModuleIsImplemented() {    \
    static Implementation module;              \
    return &module;                            \
  }
