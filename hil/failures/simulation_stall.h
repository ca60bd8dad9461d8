#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 10, simulation stalls: a hand leads the tool in a bowl of 20 N/mm (R = 25 mm), through the servo loop and
/// an arm of 15 Hz. While the tool is pressed and moves (out of the bone at .25 m/s, deeper at .1 m/s, along
/// it at .1 m/s) no frame comes for 20 to 200 ms. Metric: the most that the virtual side has given back
/// beyond what it took, max over time of the sum of F_coupling dx, with the coupling's damping off so that it
/// can not hide any. Baseline: the force of the last frame, held while none comes. Bounds: .02 J; and where
/// frames come again the rendered force changes by less than 10 % of what it was before the stall in any
/// millisecond.
[[nodiscard]] FailureResult RunSimulationStall(const FailureSetting& setting);

}  // namespace osteon::hil
