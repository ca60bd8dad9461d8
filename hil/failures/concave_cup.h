#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 3, concave cup: reamers of R = 24 and 24.98 mm pressed 5 mm into a packed cup of 25 mm, up to 45 degrees
/// from its axis, at 50 deg/s, 1 kHz, spindle off, no friction. What counts is the angle between the force
/// and the direction to the middle of the cup, which the force has on a smooth wall; and how much the force
/// turns in a millisecond. Baseline: the normal of the one pair that was met, the proxy sliding on its plane.
/// Bounds: 1 deg; .3 deg per ms; never more than 90.
[[nodiscard]] FailureResult RunConcaveCup(const FailureSetting& setting);

}  // namespace osteon::hil
