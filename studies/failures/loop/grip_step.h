#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 16, grip: a hand of 300 N/m moves the tool of an arm of 15 Hz through free space, through the
/// servo loop. Then the hand suddenly stiffens to 6000 N/m (without a jump of its wrench), with various
/// damping and mass, or a clamp of 50 kN/m closes on the handle. The sensor's noise is 0.1 N rms. Metric: RMS
/// value of the force on the tool between 5 and 40 Hz, as the largest over any Hann window of 0.2 s. The
/// windows lie between 0.5 s and 4 s after the step. Baseline: a fixed virtual mass of 2 kg and drag of 10 N
/// s/m. Ours: the default law with the vibration index (control/stability/vibration_index.h). Bound: 0.5 N in
/// every case. The baseline must fail in every case.
[[nodiscard]] FailureResult RunGripStep(const FailureSetting& setting);

}  // namespace osteon::studies
