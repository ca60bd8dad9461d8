#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "base/clock.h"
#include "kinematics/spatial.h"

namespace osteon::hil {

/// Errors between the load on a force sensor and its reading; none by default.
struct SensorModelParams {
  double noise_N{0.0}, noise_Nm{0.0};              ///< RMS value of white noise
  PlainWrench bias{};                              ///< reading without a load, in N and N·m
  PlainVector3 drift_N_per_s{}, drift_Nm_per_s{};  ///< rate of change of the bias, from the first sample on
  //
  double range_N{1e9}, range_Nm{1e9};
  std::uint32_t seed{1};
};

/// Reading = clamp(load + bias + drift t + noise). The same seed and calls give the same readings.
class SensorModel {
 public:
  struct Sample {
    std::array<double, 6> value{};  ///< Fx Fy Fz [N], Tx Ty Tz [N·m]
    unsigned saturated{0};          ///< bit i: axis i exceeds its range
  };

  /// @throws std::invalid_argument on a negative noise or a range that is not positive.
  explicit SensorModel(const SensorModelParams& params);

  Sample Read(rt::Nanoseconds now, const Wrench& load) noexcept;

 private:
  double Normal() noexcept;

  SensorModelParams params_;
  std::mt19937 random_;
  rt::Nanoseconds start_{-1};
};

}  // namespace osteon::hil
