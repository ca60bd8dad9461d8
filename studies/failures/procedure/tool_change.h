#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 32: another reamer is put on: the apex jumps, the joints must not.
[[nodiscard]] FailureResult RunToolChange(const FailureSetting& setting);

}  // namespace osteon::studies
