#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 11, fast rotation: a ball on a lever of L = 60 to 150 mm turns at 135 to 360 deg/s. One frame
/// comes after a stall of 100 ms, so it contains a turn of 13 to 36 degrees. A post stands outside the middle
/// of the arc and reaches into the ball's path by half the sagitta (the arc's height above its chord), so
/// that the straight chord misses the post.
///
/// Metric: penetration of the ball into the post on its true arc, up to first contact. A frame of 1 ms
/// without the stall, which turns by θ, would also penetrate, by L θ²/8 (less than 1 µm); this is subtracted.
/// Baseline: the straight chord (the paper's method, corrected). Bound: 10 µm.
///
/// The penetration that remains after sliding along the post is due to CuttingParams::contact_tolerance_m.
/// The result's note states it.
[[nodiscard]] FailureResult RunFastRotation(const FailureSetting& setting);

}  // namespace osteon::studies
