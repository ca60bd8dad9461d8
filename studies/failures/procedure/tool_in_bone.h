#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 34, tool in bone: a larger reamer is mounted at the place of the smaller one, in its cavity.
/// Metric: the tool's depth in bone when motion resumes. Baseline: motion resumes at that place. Ours:
/// refuses motion until the tool is retracted. Bound: 0.
[[nodiscard]] FailureResult RunToolInBone(const FailureSetting& setting);

}  // namespace osteon::studies
