#pragma once

#include <cstdint>

namespace osteon::simulation {

/// Step of the generator SplitMix64 (Steele, Lea, Flood, OOPSLA 2014). Each draw adds the step to the state,
/// and MixBits of the state is the random number.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15ULL;
/// Output function of SplitMix64: a bijection whose result looks random.
[[nodiscard]] constexpr std::uint64_t MixBits(std::uint64_t bits) {
  bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9ULL;
  bits = (bits ^ bits >> 27) * 0x94d049bb133111ebULL;
  return bits ^ bits >> 31;
}

/// Pseudo-random bits, a function of the argument.
[[nodiscard]] constexpr std::uint64_t Scramble(std::uint64_t bits) { return MixBits(bits + kSplitMixStep); }

/// Number in [0, 1) from the upper 53 bits.
[[nodiscard]] constexpr double Uniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

}  // namespace osteon::simulation
