#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 34, tool in bone: a larger reamer is mounted at the place where the smaller one stands. Metric:
/// the tool's depth in bone when motion resumes. Baseline: motion resumes right there. Ours: refuses until
/// the tool is retracted. Bound: 0.
[[nodiscard]] FailureResult RunToolInBone(const FailureSetting& setting);

}  // namespace osteon::studies
