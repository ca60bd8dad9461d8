#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 11, fast rotation: a ball on a lever of 60 to 150 mm turns at 135 to 360 deg/s; a frame comes after a
/// stall of 100 ms, so the turn is one of 13 to 36 degrees. A post stands on the outer side of the arc's
/// middle, reaching half as far into the ball's arc as the arc is higher than its chord: the straight chord
/// misses it. Metric: how deep the ball enters the post on its true arc, up to first contact, beyond
/// L θ²/8 of one frame at 1 kHz (what the rotation costs without the stall: less than 1 µm). Baseline: the
/// straight chord (the paper's method, corrected). Bound: 10 µm. What sliding along the post then leaves is
/// CuttingParams::contact_tolerance_m's; the note has it.
[[nodiscard]] FailureResult RunFastRotation(const FailureSetting& setting);

}  // namespace osteon::hil
