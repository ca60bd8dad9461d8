#pragma once

#include <vector>

#include "control/setup/servo_params.h"
#include "hil/operator/hand_grid.h"

namespace osteon::studies {

/// A run through the servo loop with an arm of 15 Hz: a hand of 300 N/m swings the tool through free space,
/// at 0.5 Hz over 30 mm; the sensor's noise is 0.1 N rms. At step_s the hand stiffens without a jump of its
/// wrench, or a clamp closes.
struct GripTrialParams {
  /// The hand, or the clamp, from step_s on.
  hil::GridHand after{"stiff", 6000.0, 13.0, 1.1};
  /// True: a clamp closes and its wrench jumps; false: the hand stiffens and its wrench does not jump.
  bool clamp{false};
  control::ServoParams loop{};
  double step_s{1.3};
  double seconds{4.0};   ///< duration of the run after the step
  double tremor_N{0.0};  ///< amplitude along each axis (hil/operator/tremor.h)
  double tremor_from_s{0.0};
};

/// The result of the run. Forces are RMS values between 5 and 40 Hz over windows of kWindow_s, one window
/// every kEvery_s.
struct GripTrial {
  static constexpr double kWindow_s = 0.2, kEvery_s = 0.02;
  double calm_N{0.0};    ///< largest RMS force of a window that begins at least 0.5 s after the step
  double max_N{0.0};     ///< largest RMS force of any window
  double tremor_N{0.0};  ///< largest RMS force of the tremor alone in any window
  double index{0.0};     ///< largest vibration index
  double heavy_s{0.0};   ///< total time with more than twice the law's drag
  bool fault{false};
  std::vector<double> window_N;               ///< the hand's force, for each window
  std::vector<double> indices, references_N;  ///< vibration index and its reference, for each tick
  std::vector<double> damping_factors;        ///< factor on the law's damping, for each tick
};

/// Simulates the run. Deterministic.
[[nodiscard]] GripTrial RunGripTrial(const GripTrialParams& params);

}  // namespace osteon::studies
