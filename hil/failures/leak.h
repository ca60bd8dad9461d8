#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 8, leak: a probe of R = .1 mm is pushed 4 mm into a block at many places, spindle off. What counts is how
/// deep the proxy gets. Baseline: the same engine on an inner (disjoint) packing with as many balls as ours.
/// Bound: the median radius of the balls of that packing.
[[nodiscard]] FailureResult RunLeak(const FailureSetting& setting);

}  // namespace osteon::hil
