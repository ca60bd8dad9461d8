#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 13, joint limit: a hand leads the tool of an iiwa 14 at 0.1 m/s along the straight line on which
/// one joint alone would move it at first (A2, A4, A6 and A1 in turn). The line begins 0.3 rad before that
/// joint's limit and goes far beyond it; the hand pauses there and comes back. Metric: the tool's distance
/// from the line. Baseline: pseudo-inverse, with each joint clamped alone at its limits. Bound: 1 mm. In
/// addition no joint may come closer to its limit than the margin, the tool must not move back by more than 1
/// um on the way out, and there must be no fault.
[[nodiscard]] FailureResult RunJointLimit(const FailureSetting& setting);

}  // namespace osteon::studies
