#pragma once

#include <vector>

#include "control/setup/servo_params.h"
#include "hil/operator/hand_grid.h"

namespace osteon::studies {

/// A hand of 300 N/m swings the tool of an arm of 15 Hz through free space, at 0.5 Hz over 30 mm, through the
/// servo loop; the sensor's noise is 0.1 N rms. At step_s the hand stiffens without a jump of its wrench, or
/// a clamp closes.
struct GripRideParams {
  /// The hand, or the clamp, from step_s on.
  hil::GridHand after{"stiff", 6000.0, 13.0, 1.1};
  bool clamp{false};  ///< a clamp closes and does not keep the hand's wrench; false: the hand stiffens
  control::ServoParams loop{};
  double step_s{1.3};
  double seconds{4.0};   ///< after the step
  double tremor_N{0.0};  ///< peak along each axis (hil/operator/tremor.h)
  double tremor_from_s{0.0};
};

/// The result of the ride. Forces are RMS values between 5 and 40 Hz over windows of kWindow_s, one window
/// every kEvery_s.
struct GripRide {
  static constexpr double kWindow_s = 0.2, kEvery_s = 0.02;
  double calm_N{0.0};    ///< largest RMS force of a window, from 0.5 s after the step on
  double max_N{0.0};     ///< the same at any time
  double tremor_N{0.0};  ///< the same for the tremor alone, at any time
  double index{0.0};     ///< largest vibration index
  double heavy_s{0.0};   ///< time with more than twice the law's drag
  bool fault{false};
  std::vector<double> window_N;               ///< the hand's force, for each window
  std::vector<double> indices, references_N;  ///< vibration index and its reference, for each tick
  std::vector<double> damping_factors;        ///< factor on the law's damping, for each tick
};

/// Simulates the ride. Deterministic.
[[nodiscard]] GripRide RideGrip(const GripRideParams& params);

}  // namespace osteon::studies
