#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 41, depth on a mount: a hand presses with 120 N on bone of 12 kg whose mount has 10 Hz, through
/// the servo loop with either law, until the depth limit stops the spindle. Metric: error of the hole's
/// depth, against the same hand on bone that rests. Baseline: a depth limit that rests in the world, while
/// the bone gives way under the push. Bound: 0.1 mm, with both laws, and with pads that creep.
[[nodiscard]] FailureResult RunDepthOnMount(const FailureSetting& setting);

}  // namespace osteon::studies
