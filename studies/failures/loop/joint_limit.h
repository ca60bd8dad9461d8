#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 13, joint limit: a hand leads the tool of an iiwa 14 at 0.1 m/s along the straight line on which
/// one joint would move it (A2, A4, A6 and A1 in turn), from 0.3 rad before that joint's limit to far beyond
/// it, waits, and comes back. Metric: the tool's distance from the line. Baseline: pseudo-inverse, with each
/// joint clamped alone at its limits. Bound: 1 mm. In addition no joint may pass its limit less the margin,
/// the tool's travel along the line must be monotone on the way out (it never comes back by more than 1 um
/// while the hand pushes on), and there must be no fault.
[[nodiscard]] FailureResult RunJointLimit(const FailureSetting& setting);

}  // namespace osteon::studies
