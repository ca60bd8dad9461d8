#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 6, resting buzz: a firm hand (500 N/m) rests the tool on a plane of 20 N/mm with 5, 50 and 200 N
/// for 10 s, through the servo loop; the sensor's noise is 0.1 N rms. The arm follows without lag, since an
/// arm of 15 Hz would hide motion at 250 Hz. Metric: amplitude of the handle's motion near 250 Hz, where
/// fingers feel most: sqrt 2 times the RMS value of its true position (not the commanded one) between 200 and
/// 300 Hz, after the first second. Baseline: a force that was computed elsewhere a millisecond ago, with a
/// stiffness of 7.4 N/um, with which 3 kg oscillate at 250 Hz. With a force of that age the loop is stable
/// only up to 53 kN/m (control.md). Even with 7.4 N/um the loop would be quiet if each tick evaluated planes
/// itself. Bound: 1 um.
[[nodiscard]] FailureResult RunRestingBuzz(const FailureSetting& setting);

}  // namespace osteon::studies
