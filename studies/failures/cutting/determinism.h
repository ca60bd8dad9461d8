#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 21, determinism: one open-loop cut of 2 000 frames, twice on our engine, in two engine objects.
/// Metric: number of frames whose contact model differs in any bit; a difference of the carved state at the
/// end counts as one more. Baseline: the same normals summed in single precision over the balls in reach, in
/// the orders of two possible schedules (seeded). Bound: 0. Ours passes only if it also agrees with the
/// reference engine: first contact within 1e-4 mm along the path, normal within 0.05 deg, every ball within
/// 1e-4 mm (balls within 1e-5 mm of vanishing are exempt, and counted), mass within 1e-5.
[[nodiscard]] FailureResult RunDeterminism(const FailureSetting& setting);

}  // namespace osteon::studies
