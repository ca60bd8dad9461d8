#pragma once

#include <cmath>
#include <cstdint>
#include <random>

namespace osteon::studies {

/// Random numbers of one episode, determined by seed and index. They are computed from raw bits, since the
/// standard library's distributions differ between implementations.
class SeededDraws {
 public:
  SeededDraws(std::uint64_t seed, int index) : bits_(seed * 1'000'003u + static_cast<std::uint64_t>(index)) {}
  /// Uniform from low to high, rounded to three decimals.
  double Between(double low, double high) {
    // the upper 53 bits as a number from 0 to below 1
    const double share = static_cast<double>(bits_() >> 11) * 0x1p-53;
    return std::round(1e3 * (low + share * (high - low))) / 1e3;
  }
  /// Uniform from 0 to count - 1.
  int Index(int count) { return static_cast<int>(bits_() % static_cast<std::uint64_t>(count)); }

 private:
  std::mt19937_64 bits_;
};

}  // namespace osteon::studies
