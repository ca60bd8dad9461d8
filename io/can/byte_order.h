#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>

#include "base/marker.h"

// Reads and writes integers in frames, big-endian (highest byte first) or little-endian. Signed integers are
// converted from and to their unsigned type, which C++20 defines.

namespace osteon::io {

template <std::integral T>
[[nodiscard]] constexpr T GetBig(const std::uint8_t* bytes) OSTEON_RT {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) value = value << 8 | bytes[i];
  return static_cast<T>(value);
}

template <std::integral T>
constexpr void PutBig(T value, std::uint8_t* bytes) OSTEON_RT {
  auto rest = static_cast<std::uint64_t>(value);
  for (std::size_t i = sizeof(T); i-- > 0; rest >>= 8) bytes[i] = static_cast<std::uint8_t>(rest);
}

template <std::integral T>
[[nodiscard]] constexpr T GetLittle(const std::uint8_t* bytes) OSTEON_RT {
  std::uint64_t value = 0;
  for (std::size_t i = sizeof(T); i-- > 0;) value = value << 8 | bytes[i];
  return static_cast<T>(value);
}

template <std::integral T>
constexpr void PutLittle(T value, std::uint8_t* bytes) OSTEON_RT {
  auto rest = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i, rest >>= 8) bytes[i] = static_cast<std::uint8_t>(rest);
}

}  // namespace osteon::io
