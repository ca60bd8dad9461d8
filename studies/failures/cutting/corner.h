#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 4, corner of 90 degrees: the tool is pressed into floor and wall by 1 to 5 mm each, from several
/// sides, and held; spindle off, no friction. Metrics: difference of the force from the vector sum of both
/// faces' forces, relative to that sum; and the proxy's motion while the tool is held (a limit cycle).
/// Baseline: first contact only. Bounds: 7 %; 1 um.
[[nodiscard]] FailureResult RunCorner(const FailureSetting& setting);

}  // namespace osteon::studies
