#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 18, material step: the tool is pressed by 1 mm into cancellous bone, drawn along the surface onto
/// cortical bone, lifted, and returned through the air; spindle off, no friction. Metric: work that the hand
/// gains in a cycle. Baseline: a penalty whose stiffness follows the density of the nearest ball (k × 10).
/// Bound: at most 0.1 mJ, the trapezoidal sum's own error; and the force stays within 5 % of its final value
/// from 5 ms after the border on.
[[nodiscard]] FailureResult RunMaterialStep(const FailureSetting& setting);

}  // namespace osteon::studies
