#include "plugin/src/thread_pool.h"

#include <dlfcn.h>

#include <array>

namespace osteon::plugin {

void KeepThreadPoolMapped() {
  // The handle is never closed, on purpose: RTLD_NODELETE keeps the pool mapped until the process ends.
  static const bool kept = [] {
    constexpr std::array<const char*, 2> kNames{"libtbb.so.12", "libtbb.so.2"};
    for (const char* name : kNames)
      if (dlopen(name, RTLD_LAZY | RTLD_NOLOAD | RTLD_NODELETE)) return true;
    return false;
  }();
  static_cast<void>(kept);
}

}  // namespace osteon::plugin
