#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 34, tool in bone: a larger reamer is mounted at the place where the smaller one stands.
[[nodiscard]] FailureResult RunToolInBone(const FailureSetting& setting);

}  // namespace osteon::studies
