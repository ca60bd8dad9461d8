#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 33: a heavier reamer is mounted.
[[nodiscard]] FailureResult RunToolLoad(const FailureSetting& setting);

}  // namespace osteon::studies
