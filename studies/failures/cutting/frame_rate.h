#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 22, frame rate: one hand trajectory, a plunge of 1 mm and a traverse, at 0.25, 0.5, 1 and 2 kHz;
/// the servo loop renders the frames' planes at 4 kHz. Metric: the largest difference from 1 kHz in the
/// rendered force's mean over the plunge, over the traverse, and in the volume removed. Baseline: removal up
/// to the device's pose in every frame, on the same engine. Bound: 2 %. (The force of a frame itself belongs
/// to the pose before the bone gave way: the coupling's stretch is larger than the mean by about v dt/2, so
/// this force is 2 to 3 % larger at 0.25 kHz than at 1 kHz.)
[[nodiscard]] FailureResult RunFrameRate(const FailureSetting& setting);

}  // namespace osteon::studies
