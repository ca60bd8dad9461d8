#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 16, grip: a hand of 300 N/m moves the tool of an arm of 15 Hz through free space, through the
/// servo loop. At once the hand stiffens to 6000 N/m (with the same wrench), with various damping and mass,
/// or a clamp of 50 kN/m closes on the handle; the sensor's noise is 0.1 N rms. Metric: RMS value of the
/// force on the tool between 5 and 40 Hz, the largest in any 0.2 s (a Hann window) from 0.5 s after the step
/// until the end, 4 s after it. Baseline: m_v = 2 kg, b_v = 10 N s/m, fixed. Ours: the default law with the
/// vibration index (control/stability/vibration_index.h). Bound: 0.5 N in every case, and the baseline fails
/// in every case.
[[nodiscard]] FailureResult RunGripStep(const FailureSetting& setting);

}  // namespace osteon::studies
