#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 40, drill walks: a drill of 3.2 mm, guided along its axis, meets cortex that is tilted by 20
/// degrees. Its tip bends aside until the hole is deep enough to guide it. The scenario runs through the
/// servo loop, once with the admittance law and once with the impedance law. Metric: distance of the hole,
/// 1.5 s after the push began, from the hole of a reference run, which has the same path of the handle and a
/// fifth of the loop's period. Baseline: a rigid drill, whose hole is where it was aimed. A second baseline,
/// which solves the bending together with each frame's planes, overshoots; FailureResult::note states its
/// error. Bound: 0.1 mm, with both laws.
[[nodiscard]] FailureResult RunDrillWalk(const FailureSetting& setting);

}  // namespace osteon::studies
