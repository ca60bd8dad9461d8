#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>

#include "kinematics/spatial.h"

namespace osteon::hil {

/// A hand's physiological tremor, modelled as a force. Along each axis it is the sum of three sinusoids
/// between 8 and 12 Hz with random phases, so its amplitude beats.
class Tremor {
 public:
  /// @param peak_N  peak force along each axis; 0: no tremor
  Tremor(double peak_N, std::uint64_t seed) : peak_N_(peak_N) {
    // use raw bits instead of a distribution, so that the phases are the same with every standard library
    std::mt19937_64 bits(seed);
    for (auto& axis : phase_rad_)
      for (double& phase : axis) phase = 2.0 * std::numbers::pi * static_cast<double>(bits() >> 11) * 0x1p-53;
  }

  /// The tremor's force [N] at this time.
  [[nodiscard]] Vector3 ForceAt(double time_s) const noexcept {
    Vector3 f = Vector3::Zero();
    if (peak_N_ == 0.0) return f;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t i = 0; i < kHz.size(); ++i)
        f[static_cast<Eigen::Index>(axis)] +=
            peak_N_ / 3.0 * std::sin(2.0 * std::numbers::pi * kHz[i] * time_s + phase_rad_[axis][i]);
    return f;
  }

 private:
  static constexpr std::array<double, 3> kHz{8.3, 9.7, 11.1};  // frequencies of the three sinusoids
  double peak_N_;
  std::array<std::array<double, 3>, 3> phase_rad_{};  // by axis, then by sinusoid
};

}  // namespace osteon::hil
