#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "gpu/shaders/layout.h"

// Frames for passes without shaderFloat64, which compute in double-singles (shaders/double_single.glsl): a
// double's eight bytes hold the nearest float, then the remainder as a float.

namespace osteon::gpu {

/// Key of a path fraction before any contact is found. Its upper word is that of the number 2, the same for a
/// double and for a float key; its lower word is all ones. No key with the same upper word is larger. Passes
/// without 64-bit integers need this, because they find the smallest upper word first (words.glsl).
inline constexpr Key64 kNoContactKey = 0x40000000ffffffff;

[[nodiscard]] constexpr std::uint64_t ToDoubleSingle(double value) {
  const auto nearest = static_cast<float>(value);
  const auto rest = static_cast<float>(value - static_cast<double>(nearest));
  return std::uint64_t{std::bit_cast<std::uint32_t>(rest)} << 32 | std::bit_cast<std::uint32_t>(nearest);
}
[[nodiscard]] constexpr double FromDoubleSingle(std::uint64_t floats) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(floats))) +
         static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(floats >> 32)));
}

/// Returns the number of which ToKey (shaders/exact.glsl) has made this key.
[[nodiscard]] constexpr double FromDoubleSingleKey(Key64 key) {
  const auto rest = static_cast<std::uint32_t>(key);
  const std::uint32_t bits = (rest >> 31) != 0 ? rest & 0x7fffffffu : ~rest;
  return FromDoubleSingle(std::uint64_t{bits} << 32 | key >> 32);
}

/// Replaces a frame's doubles by double-singles.
void ToDoubleSingles(Frame& frame);

/// Replaces a frame's double-singles by doubles and the key of first contact by a double's bits, and converts
/// the sums to units of 1 / kUnitSubdivision.
void FromDoubleSingles(Frame& frame);

}  // namespace osteon::gpu
