#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 8, leak: a probe of R = 0.1 mm is pushed 4 mm into a block at many places, spindle off. Metric:
/// penetration of the proxy. Baseline: the same engine on an inner (disjoint) packing, with a quarter as many
/// balls as ours. Bound: the median radius of that packing's balls.
[[nodiscard]] FailureResult RunLeak(const FailureSetting& setting);

}  // namespace osteon::studies
