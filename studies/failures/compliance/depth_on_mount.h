#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 41, depth on a mount: a hand presses with 120 N on bone of 12 kg on a mount of 10 Hz, through the
/// servo loop, until the depth limit stops the spindle. Metric: difference of the hole's depth from that in
/// fixed bone with the same hand. Baseline: a depth limit that is fixed in the world, while the bone moves
/// under the push. Bound: 0.1 mm, with the admittance law and with the impedance law, and with pads that
/// creep.
[[nodiscard]] FailureResult RunDepthOnMount(const FailureSetting& setting);

}  // namespace osteon::studies
