#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 18, material step: the tool is pressed by 1 mm into cancellous bone, drawn along the surface onto
/// cortical bone, lifted, and returned through the air; spindle off, no friction. Metric: work that the hand
/// gains in a cycle. Baseline: a penalty force whose stiffness follows the density of the nearest ball (10
/// times stiffer in cortical bone). Bounds: 0.1 mJ, the error of the trapezoidal sum; and from 5 ms after the
/// border on, the force is within 5 % of its final value.
[[nodiscard]] FailureResult RunMaterialStep(const FailureSetting& setting);

}  // namespace osteon::studies
