#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 19, breakthrough: a hand (2 kg, 200 N·s/m, a steady push of 100 N) drives a ball burr of R 1.6 mm through
/// a wall of 1 to 2 mm at the rate law, 1 kHz. Ours: SceneWatch flags the breakthrough, and from then on a
/// depth limit 1 mm below the proxy holds it (the tool's coupling may not pull it deeper). Metric: how far
/// the hand goes on after the breakthrough within 100 ms. Baseline: the proxy jumps to the tool where the
/// wall gives way, and nothing holds the hand. Bound: 3 mm. Ours passes if, besides, the proxy never leads
/// the tool along the feed (1 µm of rounding) and the flag comes within one frame of the frame in which the
/// proxy's apex passes the wall's far side.
[[nodiscard]] FailureResult RunBreakthrough(const FailureSetting& setting);

}  // namespace osteon::hil
