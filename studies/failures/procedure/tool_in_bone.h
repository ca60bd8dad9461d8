#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 34: a larger reamer is taken where the smaller one stands.
[[nodiscard]] FailureResult RunToolInBone(const FailureSetting& setting);

}  // namespace osteon::studies
