#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 40, drill walks: a drill of 3.2 mm, guided along its axis, meets cortex that is tilted by 20
/// degrees, and bends aside until its hole holds it, through the servo loop with either law. Metric: error of
/// the hole's place 1.5 s after the push began, against the same path of the handle at a fifth of the period.
/// Baseline: a rigid drill, whose hole is where it was aimed. A second baseline, which solves the bending
/// together with each frame's planes, overshoots; the note has its error. Bound: 0.1 mm, with both laws.
[[nodiscard]] FailureResult RunDrillWalk(const FailureSetting& setting);

}  // namespace osteon::studies
