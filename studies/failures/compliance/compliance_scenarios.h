#pragma once

#include "studies/failures/failure.h"

// Scenarios of compliant parts between tool and bone (tool, surface layer, mount), simulated with the shipped
// coupling and its elements (control/compliance).

namespace osteon::studies {

/// Scenario 36, two springs: the tool circles between two planes 60 degrees apart, and one plane has a soft
/// layer. Metric: work that the planes do on the tool in a round. Baseline: the series stiffness of coupling
/// and layer is written into the soft plane's contact, so that the force field has a curl. Bound: 0.
[[nodiscard]] FailureResult RunTwoSprings(const FailureSetting& setting);

/// Scenario 37, stale stiffness: a ball presses into a soft layer by 2 ± 1.5 mm at 8 Hz. Metric: work that
/// the layer does on the tool in a cycle. Baseline: each frame sets the layer's secant stiffness until the
/// next frame. Bound: 0.
[[nodiscard]] FailureResult RunStaleStiffness(const FailureSetting& setting);

/// Scenario 38, bent arm: a drill slides and turns against an inclined plane. Metric: work that the plane
/// does on the tool in a cycle. Baseline: the torque is computed with the rigid tool's lever arm, although
/// the drill's head is bent aside. Bound: 0.01 mJ.
[[nodiscard]] FailureResult RunBentArm(const FailureSetting& setting);

}  // namespace osteon::studies
