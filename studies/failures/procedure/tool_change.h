#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 32, tool change: when another reamer is mounted, the apex jumps, but the joints must not.
[[nodiscard]] FailureResult RunToolChange(const FailureSetting& setting);

}  // namespace osteon::studies
