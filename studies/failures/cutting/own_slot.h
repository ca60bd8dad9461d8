#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 5, own slot: a reamer of R = 2 mm with a shaft of R = 1.85 mm cuts a slot of 4 mm depth, stops,
/// tilts in the slot by 14 degrees and is drawn out. Metric: penetration of the proxy into bone after the
/// cut. Baseline: equation 3 with positive roots only, on the same carved bone; it ignores every pair that
/// already overlaps. Bound: 0.05 mm; in addition the tool must come out.
[[nodiscard]] FailureResult RunOwnSlot(const FailureSetting& setting);

}  // namespace osteon::studies
