#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 32, tool change: a reamer of 46 mm is mounted instead of one of 44 mm. The apex jumps, but the
/// joints must not. Metric: travel of the flange in the tick of the change. Baseline: the apex keeps its
/// place, so the flange moves back at once. Bound: 0.
[[nodiscard]] FailureResult RunToolChange(const FailureSetting& setting);

}  // namespace osteon::studies
