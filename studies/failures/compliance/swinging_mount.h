#pragma once

#include <optional>

#include "control/stability/vibration_index.h"
#include "hil/operator/hand_grid.h"
#include "studies/failures/failure.h"

namespace osteon::studies {

/// A run of 5 s through the servo loop of an admittance cell on an arm of 15 Hz. A hand with a tremor presses
/// with up to 100 N on bone of 12 kg and releases it, 0.7 times a second.
struct SwingTrialParams {
  hil::GridHand hand;
  double tremor_N{1.0};              ///< amplitude along each axis (hil/operator/tremor.h)
  std::optional<double> mount_hz{};  ///< frequency of the bone's mount; absent: the bone is fixed
  control::VibrationParams index{};
};

/// The result of the run.
struct SwingTrial {
  double mean_drag{0.0};  ///< mean factor on the law's drag, from 1 s after the start on
  double swing_m{0.0};    ///< range of the tool's height, from 1 s after the start on
  bool fault{false};
  FailureSeries drag{};  ///< factor on the law's drag, over the time [s]
};

/// Simulates the run. Deterministic.
[[nodiscard]] SwingTrial RunSwingTrial(const SwingTrialParams& params);

/// Scenario 42, swinging mount: bone that is pressed and released swings on its mount at 4 to 20 Hz, within
/// the band of the vibration index. Metric: increase of the mean drag over that on fixed bone with the same
/// index. Baseline: an index that remembers the slow push for only 20 ms: when the push reverses, this index
/// measures nothing but the swing. Bound: 15 %. The impedance law has no vibration index, so its drag can't
/// rise.
[[nodiscard]] FailureResult RunSwingingMount(const FailureSetting& setting);

}  // namespace osteon::studies
