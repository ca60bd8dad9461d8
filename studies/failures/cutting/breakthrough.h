#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 19, breakthrough: a hand (2 kg, 200 N·s/m, a steady push of 100 N) drives a ball burr of R 1.6 mm
/// through a wall of 1 to 2 mm with the rate law, at 1 kHz. Ours: a depth limit holds the tool; its bound
/// lies 1 mm beyond the place of the pushed tool when it has cut through the wall. SceneWatch flags the
/// breakthrough. Metric: travel of the hand within 100 ms after the breakthrough. Baseline: no depth limit,
/// and from the flag on no force on the hand, as if the proxy had jumped to the tool. Bound: 3 mm. Ours
/// passes only if, in addition, the proxy never leads the tool along the feed (1 µm of rounding allowed), and
/// the flag comes within one frame of the frame in which the proxy's apex passes the wall's far side.
[[nodiscard]] FailureResult RunBreakthrough(const FailureSetting& setting);

}  // namespace osteon::studies
