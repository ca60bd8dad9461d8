#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 9, high feed: a slot milled along a wave, half a ball deep; R 0.5 to 5 mm, 50 to 1000 mm/s, 60 to
/// 1000 Hz, removal up to the tool's pose (RemovalLaw::kImmediate), so that the tool follows any feed.
/// Metric: how deep remaining balls reach into the volume that the proxy's path swept. Baseline: stamps at
/// discrete poses. Bound: 1 µm, the rounding of coordinates in single precision; nothing may remain there.
/// The same bound holds for the proxy's distance from the hand at the end of a frame: the whole path is cut,
/// and nothing beside it.
[[nodiscard]] FailureResult RunHighFeed(const FailureSetting& setting);

}  // namespace osteon::studies
