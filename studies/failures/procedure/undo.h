#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 35: a pass is taken back, done again, and the session resumed.
[[nodiscard]] FailureResult RunUndo(const FailureSetting& setting);

}  // namespace osteon::studies
