#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 10, simulation stalls: a hand leads the tool in a bowl of 20 N/mm (R = 25 mm), through the servo
/// loop and an arm of 15 Hz. While the tool is pressed and moves (out of the bone at 0.25 m/s, deeper at 0.1
/// m/s, or along the surface at 0.1 m/s), no frame comes for 20 to 200 ms. Metric: the largest energy that
/// the virtual side has given in excess of the energy that it took: max over time of the sum of F_coupling
/// dx, without the coupling's damping, which could hide some of it. Baseline: the force of the last frame,
/// held during the stall. Bounds: 0.02 J; and after the stall the rendered force changes in any millisecond
/// by less than 10 % of its value before the stall.
[[nodiscard]] FailureResult RunSimulationStall(const FailureSetting& setting);

}  // namespace osteon::studies
