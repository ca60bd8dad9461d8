#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 22, frame rate: the same hand trajectory, a plunge of 1 mm and a traverse, with frames at 0.25,
/// 0.5, 1 and 2 kHz; the servo loop renders the frames' planes at 4 kHz. Metric: the largest relative
/// difference from the run at 1 kHz: of the mean rendered force over the plunge, of that over the traverse,
/// or of the removed volume. Baseline: removal up to the tool's pose in every frame (immediate law), on the
/// same engine. Bound: 2 %.
///
/// The metric uses the rendered force, not the frame's own force. A frame's own force belongs to the pose
/// before the bone gave way: the coupling's deflection is then larger than its mean by about v dt/2, so that
/// this force is 2 to 3 % larger at 0.25 kHz than at 1 kHz.
[[nodiscard]] FailureResult RunFrameRate(const FailureSetting& setting);

}  // namespace osteon::studies
