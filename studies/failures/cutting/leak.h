#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 8, leak: a probe of R = 0.1 mm is pushed 4 mm into a block at many places, spindle off. Metric:
/// penetration of the proxy. Baseline: the same engine on a disjoint packing, with a quarter as many balls as
/// our overlapping packing. Bound: the median radius of the disjoint packing's balls.
[[nodiscard]] FailureResult RunLeak(const FailureSetting& setting);

}  // namespace osteon::studies
