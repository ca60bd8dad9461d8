#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 21, determinism: one open-loop cut of 2 000 frames is run twice on our engine, in two engine
/// objects. Metric: number of frames whose contact models differ in any bit; a difference of the carved state
/// at the end counts as one more. Baseline: the same normals summed in single precision over the balls in
/// reach, in two random orders, as a parallel engine might sum them. Bound: 0. Ours passes only if it also
/// agrees with the reference engine: first contact within 1e-4 mm along the path, normal within 0.05 deg,
/// every ball within 1e-4 mm, mass within 1e-5. Balls within 1e-5 mm of vanishing are exempt; their number is
/// stated.
[[nodiscard]] FailureResult RunDeterminism(const FailureSetting& setting);

}  // namespace osteon::studies
