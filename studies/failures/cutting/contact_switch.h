#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 2, contact switch: a tool of two equal balls of R = 3 mm, 10 mm apart, presses on a flat block
/// with 200 N and rocks by ±0.1 mm at 2 Hz, spindle off, 1 kHz. Metric: largest change of the torque on the
/// tool from one millisecond to the next. Baseline: equation 2, the force of the first contact's pair alone.
/// Bounds: 0.05 N·m per ms, and 7 % of the force per ms.
[[nodiscard]] FailureResult RunContactSwitch(const FailureSetting& setting);

}  // namespace osteon::studies
