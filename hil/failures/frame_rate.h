#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 22, frame rate: one hand trajectory, a plunge of 1 mm and a way across, at .25, .5, 1 and 2 kHz. Metric:
/// the largest difference from 1 kHz in the force's mean over each tenth of the run that is in contact, and
/// in the volume removed. Baseline: removal up to the device's pose in every frame, on the same engine.
/// Bound: 2 %.
[[nodiscard]] FailureResult RunFrameRate(const FailureSetting& setting);

}  // namespace osteon::hil
