#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 35, undo: a pass is undone and cut again, and a session is resumed. Each must leave the same bone
/// as two passes in a row.
[[nodiscard]] FailureResult RunUndo(const FailureSetting& setting);

}  // namespace osteon::studies
