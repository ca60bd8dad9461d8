#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 3, concave cup: reamers of R = 24 and 24.98 mm are pressed 5 mm into a packed cup of R = 25 mm,
/// and moved along its wall up to 45 degrees from its axis at 50 deg/s, 1 kHz, spindle off, no friction. On a
/// smooth wall the force would point to the cup's centre. Metrics: the angle between the force and the
/// direction to the cup's centre; and the change of the force's direction in a millisecond. Baseline: the
/// normal of the first contact's pair, with the proxy sliding on that pair's plane. Bounds: 1 deg; 0.3 deg
/// per ms; and no angle above 90 deg.
[[nodiscard]] FailureResult RunConcaveCup(const FailureSetting& setting);

}  // namespace osteon::studies
