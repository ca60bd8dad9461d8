#pragma once

#include "studies/failures/failure.h"

// Scenarios of a surgical plan and of its assessment.

namespace osteon::studies {

/// Scenario 23, cup definitions: a cup is planned at 40° of inclination and 20° of anteversion, by the
/// radiographic definition. Metric: angle between the planned axis and the axis that is used. Baseline: the
/// two numbers are read as operative angles. Ours: the axis is converted to each of the three definitions and
/// back. Bound: 1e-9°.
[[nodiscard]] FailureResult RunCupDefinition(const FailureSetting& setting);

/// Scenario 24, wrong side: a plan for a left hip is used on the right one. Metric: angle between the
/// accepted axis and the axis of the native cup. Baseline: the mirrored axis is accepted. Ours: the plan is
/// refused, so no axis is accepted. Bound: 45°; a plan beyond it is refused.
[[nodiscard]] FailureResult RunWrongSide(const FailureSetting& setting);

/// Scenario 25, fit of a small cap: spheres are fitted to points on a cap of 46° of a sphere of 25 mm, with
/// errors of 0.3 mm (standard deviation), many times. Metric: bias of radius or depth, whichever is larger.
/// Baseline: the algebraic fit (least squares of |p|²). Ours: the geometric fit of procedure/assessment.
/// Bound: 0.02 mm.
[[nodiscard]] FailureResult RunSmallCap(const FailureSetting& setting);

/// Scenario 26, fit in a coarse packing: a reamer of 50 mm cuts a cup of large balls. Metric: error of the
/// fitted diameter. Baseline: a sphere through the points at which rays meet the remaining balls, some of
/// which lie in the valleys between balls. Ours: the point of each cut ball that is nearest to the cup's
/// centre. Bound: 0.01 mm.
[[nodiscard]] FailureResult RunCoarsePacking(const FailureSetting& setting);

}  // namespace osteon::studies
