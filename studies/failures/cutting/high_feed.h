#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 9, high feed: a slot is milled along a wave, half a ball deep; R 0.5 to 5 mm, 50 to 1000 mm/s, 60
/// to 1000 Hz. Bone is removed up to the tool's pose (RemovalLaw::kImmediate), so that the proxy follows at
/// any feed. Metric: depth to which the remaining balls reach into the volume that the proxy's path swept.
/// Baseline: removal only at the discrete poses of the frames. Bound: 1 µm, the rounding of coordinates in
/// single precision. The same bound holds for the proxy's distance from the hand at the end of a frame: the
/// whole path is cut, and nothing beside it.
[[nodiscard]] FailureResult RunHighFeed(const FailureSetting& setting);

}  // namespace osteon::studies
