#pragma once

#include <cstdint>

namespace osteon::simulation {

/// SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): its state goes on by this step, and a number is MixBits of
/// it.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15ULL;
[[nodiscard]] constexpr std::uint64_t MixBits(std::uint64_t bits) {
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111ebULL;
  return bits ^ bits >> 31;
}

/// Bits that look random, one set for each argument.
[[nodiscard]] constexpr std::uint64_t Scramble(std::uint64_t bits) { return MixBits(bits + kSplitMixStep); }

/// In [0, 1), of the bits' upper 53.
[[nodiscard]] constexpr double Uniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace osteon::simulation
