#pragma once

#include <optional>

#include "control/stability/vibration_index.h"
#include "hil/operator/hand_grid.h"
#include "studies/failures/failure.h"

namespace osteon::studies {

/// A ride of 5 s through the servo loop of an admittance cell on an arm of 15 Hz: a hand with a tremor
/// presses with up to 100 N on bone of 12 kg and lets go, 0.7 times a second.
struct SwingRideParams {
  hil::GridHand hand;
  double tremor_N{1.0};              ///< peak along each axis (hil/operator/tremor.h)
  std::optional<double> mount_hz{};  ///< frequency of the bone's mount; absent: the bone rests
  control::VibrationParams index{};
};

/// The result of the ride.
struct SwingRide {
  double mean_drag{0.0};  ///< mean factor on the law's drag, from 1 s on
  double swing_m{0.0};    ///< distance between the tool's lowest and highest place in that time
  bool fault{false};
  FailureSeries drag{};  ///< factor, by the time [s]
};

/// Simulates the ride. Deterministic.
[[nodiscard]] SwingRide RideSwingingMount(const SwingRideParams& params);

/// Scenario 42, swinging mount: bone that is pressed and let go swings on its mount, at 4 to 20 Hz, within
/// the band of the vibration index. Metric: mean drag beyond that of the same index on bone that rests.
/// Baseline: an index that remembers the slow push for 20 ms only: when the push turns, the index measures
/// nothing but the swing.
/// Bound: 15 %. The impedance law has no vibration index, so nothing there could raise its drag.
[[nodiscard]] FailureResult RunSwingingMount(const FailureSetting& setting);

}  // namespace osteon::studies
