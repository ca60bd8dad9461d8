#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 13, joint limit: a hand leads the tool of an iiwa 14 at .1 m/s along the straight line on which one joint
/// would move it (A2, A4, A6 and A1 in turn), from .3 rad before that joint's limit to far beyond it, waits,
/// and comes back. What counts is how far the tool leaves the line. Baseline: pseudo-inverse, each joint
/// clamped at its limits alone. Bound: 1 mm; and no joint beyond its limit less the margin, the tool's way
/// along the line monotone on the way out (it never comes back by more than 1 um while the hand pushes on),
/// no fault.
[[nodiscard]] FailureResult RunJointLimit(const FailureSetting& setting);

}  // namespace osteon::hil
