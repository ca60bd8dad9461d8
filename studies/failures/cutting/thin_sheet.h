#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 1, thin sheet. A ball of radius R = 1 to 5 mm that does not cut is shot at a plate of 1 mm, at 10
/// to 1000 mm/s, in frames of 1 ms. Each shot starts at a random height, is inclined by up to 30 degrees, and
/// ends when the hand is 2 R + 2 mm beyond the plate. The ball has passed through if the proxy's centre ends
/// below the plate.
///
/// Metric: number of shots that pass through. Baseline: voxmap and pointshell, a penalty force at discrete
/// poses. Bound: 0.
[[nodiscard]] FailureResult RunThinSheet(const FailureSetting& setting);

}  // namespace osteon::studies
