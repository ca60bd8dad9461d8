#pragma once

#include "studies/failures/failure.h"

namespace osteon::hil {

/// 1, thin sheet: shots at a plate of 1 mm, spindle off, 1 kHz; tool R 1 to 5 mm, 10 to 1000 mm/s, inclined
/// by up to 30 degrees, from a random height, until the hand is 2 R + 2 mm beyond the plate. A shot passes
/// through if the proxy's centre ends below the plate. Baseline: voxmap and pointshell, a penalty at discrete
/// poses. Bound: 0.
[[nodiscard]] FailureResult RunThinSheet(const FailureSetting& setting);

}  // namespace osteon::hil
