#pragma once

#include "hil/failures/failure.h"

namespace osteon::hil {

/// 17, saturation: a hand presses an iiwa 14 with a tool of 200 and 300 mm against planes across the tool,
/// toward every side, with up to 200 N, holds, and draws back: A6 (40 N·m) holds about half of that there.
/// Through the servo loop with the arm's torques as its limit. Metric: angle between the force that is
/// rendered and the one that was to be. Baseline: the joint torques of that one, each clipped at its limit,
/// and the force that they make, J^-T tau. Bound: 1 deg; and |J^T F| + |g| within every torque limit, the
/// forces within 200 N, and the whole force back within 50 ms of the moment from which on the arm can hold
/// it.
[[nodiscard]] FailureResult RunSaturation(const FailureSetting& setting);

}  // namespace osteon::hil
