#pragma once

#include <cstddef>

#include "base/marker.h"

namespace osteon::rt {

/// Asks the processor to load an object's cache lines, and does not wait for them. The object is not read, so
/// another thread may write to it at the same time. Memory that the object points to is not loaded.
template <class T>
void Prefetch(const T& object) OSTEON_RT {
  constexpr std::size_t kCacheLine = 64;
  const char* const bytes = reinterpret_cast<const char*>(&object);
  for (std::size_t at = 0; at < sizeof object; at += kCacheLine) __builtin_prefetch(bytes + at);
}

}  // namespace osteon::rt
