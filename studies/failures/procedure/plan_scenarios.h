#pragma once

#include "studies/failures/failure.h"

// Scenarios of a surgical plan and of its assessment.

namespace osteon::studies {

/// Scenario 23, cup definitions: a cup is planned at 40° of inclination and 20° of anteversion, radiographic.
/// Metric: angle between the planned axis and the one that is used. Baseline: the two numbers read as
/// operative angles. Ours: the axis by any of the three definitions and back. Bound: 1e-9°.
[[nodiscard]] FailureResult RunCupDefinition(const FailureSetting& setting);

/// Scenario 24, wrong side: a plan for a left hip is used at the right one. Metric: angle between the axis
/// that is accepted and the native cup's. Baseline: the mirrored axis. Ours: the plan is refused; nothing is
/// accepted. Bound: 45°, from which on a plan is refused.
[[nodiscard]] FailureResult RunWrongSide(const FailureSetting& setting);

/// Scenario 25, fit of a small cap: points on a cap of 46° of a sphere of 25 mm, with errors of 0.3 mm
/// (standard deviation), many times. Metric: bias of radius or depth, the larger. Baseline: the algebraic fit
/// (least squares of |p|²). Ours: the geometric fit of procedure/assessment. Bound: 0.02 mm.
[[nodiscard]] FailureResult RunSmallCap(const FailureSetting& setting);

/// Scenario 26, fit in a coarse packing: a reamer of 50 mm cuts a cup of large balls. Metric: error of the
/// fitted diameter. Baseline: a sphere through the points where rays meet the remaining balls, also in
/// the valleys between them. Ours: the cut balls' near points. Bound: 0.01 mm.
[[nodiscard]] FailureResult RunCoarsePacking(const FailureSetting& setting);

}  // namespace osteon::studies
