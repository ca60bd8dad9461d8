#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 7, cogging: a head of R = 5 mm, packed like any tool with balls of 1 mm, slides at 50 mm/s over a
/// flat packing under 100 N, spindle off, no friction, 1 kHz. Metric: largest tangential force divided by the
/// mean normal force. Baseline: the same tool with the plane of the first contact's pair alone. Bound: 7 %.
[[nodiscard]] FailureResult RunCogging(const FailureSetting& setting);

}  // namespace osteon::studies
