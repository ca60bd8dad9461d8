#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 5, own slot: a reamer of R = 2 mm with a shaft of 1.85 mm cuts a slot of 4 mm, stops, tilts in it
/// by 14 degrees and is drawn out. Metric: penetration of the proxy into bone meanwhile. Baseline: equation 3
/// with positive roots only, on the same carved bone, which drops every pair that overlaps. Bound: 0.05 mm;
/// and the tool comes out.
[[nodiscard]] FailureResult RunOwnSlot(const FailureSetting& setting);

}  // namespace osteon::studies
