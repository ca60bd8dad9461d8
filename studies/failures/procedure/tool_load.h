#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 33, tool load: a heavier reamer is mounted, and nobody holds the tool. Metric: speed of the apex
/// after the change. Baseline: the loop still subtracts the first reamer's weight from the sensor's reading,
/// so the tool sinks. Bound: 1 mm/s.
[[nodiscard]] FailureResult RunToolLoad(const FailureSetting& setting);

}  // namespace osteon::studies
