#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 7, cogging: a head of R = 5 mm, packed with balls of 1 mm as any tool may be, slides at 50 mm/s over a
/// flat packing under 100 N, spindle off, no friction, 1 kHz. What counts is the largest tangential force
/// over the mean normal force. Baseline: the same tool, the plane of the one pair that was met. Bound: 7 %.
[[nodiscard]] FailureResult RunCogging(const FailureSetting& setting);

}  // namespace osteon::hil
