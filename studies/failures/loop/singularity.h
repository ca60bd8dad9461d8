#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 12, singularity: a hand leads the tool of an iiwa 14 into and past singular postures.
///
/// Elbow: outward along the line from the shoulder at 0.1 m/s and back, with the turning point 60 mm beyond
/// the reach, 0.1 mm before it, or 5 mm before it; sideways past the reach with the elbow pressed straight;
/// out of the candle posture, in which all joints are straight.
///
/// Wrist (A5 at 90 deg, where a turn of the elbow does not help): A6 turns through straight at up to 1 rad/s,
/// exactly, or on a path that misses the straight wrist by 1e-6 to 0.05 rad.
///
/// Metric: largest speed of a commanded joint as a share of its limit. Baseline: the pseudo-inverse of the
/// Jacobian. Bound: 1. In addition the hand's force changes by less than 5 N in a millisecond, there is no
/// fault, and the tool ends where the hand ends.
[[nodiscard]] FailureResult RunSingularity(const FailureSetting& setting);

}  // namespace osteon::studies
