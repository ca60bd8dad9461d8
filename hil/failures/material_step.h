#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 18, material step: pressed by 1 mm into cancellous bone, drawn along the surface onto cortical bone,
/// lifted, and back through the air; spindle off, no friction. What counts is the work that the hand gets out
/// of a cycle. Baseline: a penalty whose stiffness goes with the density of the nearest ball (k × 10). Bound:
/// no more than .1 mJ, the trapezoidal sum's own; and the force stays within 5 % of its final value 5 ms
/// after the border.
[[nodiscard]] FailureResult RunMaterialStep(const FailureSetting& setting);

}  // namespace osteon::hil
