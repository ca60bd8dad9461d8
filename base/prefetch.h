#pragma once

#include <cstddef>

#include "base/marker.h"

namespace osteon::rt {

/// Asks the processor to load an object's cache lines, without waiting and without reading: nothing changes,
/// even if another thread writes there meanwhile. Memory that the object points to is not loaded.
template <class T>
void Prefetch(const T& object) OSTEON_RT {
  constexpr std::size_t kCacheLine = 64;
  const char* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof object; at += kCacheLine) __builtin_prefetch(bytes + at);
}

}  // namespace osteon::rt
