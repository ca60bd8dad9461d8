#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 3, concave cup: reamers of R = 24 and 24.98 mm are pressed 5 mm into a packed cup of 25 mm, up to
/// 45 degrees from its axis, at 50 deg/s, 1 kHz, spindle off, no friction. Metrics: the angle between the
/// force and the direction to the cup's centre, which the force has on a smooth wall; and the force's change
/// of direction in a millisecond. Baseline: the normal of the first contact's pair, with the proxy sliding on
/// its plane. Bounds: 1 deg; 0.3 deg per ms; never more than 90.
[[nodiscard]] FailureResult RunConcaveCup(const FailureSetting& setting);

}  // namespace osteon::studies
