#pragma once

#include "studies/failures/failure.h"

// Scenarios of parts that give way between tool and bone (tool, surface layer, mount), simulated with the
// shipped coupling and its elements (control/compliance).

namespace osteon::studies {

/// Scenario 36, two springs: the tool circles between two planes 60 degrees apart, one of them soft. Metric:
/// work that the planes give in a turn. Baseline: the series stiffness written into the soft plane's contact,
/// so that the force has a curl. Bound: 0.
[[nodiscard]] FailureResult RunTwoSprings(const FailureSetting& setting);

/// Scenario 37, stale stiffness: a ball presses into a soft layer by 2 ± 1.5 mm at 8 Hz. Metric: work that
/// the layer gives in a cycle. Baseline: each frame sets the layer's secant stiffness until the next frame.
/// Bound: 0.
[[nodiscard]] FailureResult RunStaleStiffness(const FailureSetting& setting);

/// Scenario 38, bent arm: a drill slides and turns against an inclined plane. Metric: work given in a turn.
/// Baseline: the torque is computed with the rigid tool's lever arm, although the head is bent aside. Bound:
/// 0.01 mJ.
[[nodiscard]] FailureResult RunBentArm(const FailureSetting& setting);

}  // namespace osteon::studies
