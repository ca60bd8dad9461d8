#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 4, corner of 90 degrees: pressed into floor and wall by 1 to 5 mm each, from several sides, and held;
/// spindle off, no friction. What counts is the error of the force against the vector sum of both faces,
/// relative to it, and how far the proxy moves while the tool is held (a limit cycle). Baseline: first
/// contact only. Bounds: 7 %; 1 um.
[[nodiscard]] FailureResult RunCorner(const FailureSetting& setting);

}  // namespace osteon::hil
