#pragma once

#include "studies/failures/failure.h"

namespace osteon::studies {

/// Scenario 17, saturation: a hand presses an iiwa 14 with a tool of 200 and 300 mm against planes across the
/// tool, toward every side, with up to 200 N, holds, and draws back. In this posture A6 (40 N·m) holds about
/// half of that force. The servo loop limits the force by the arm's torques. Metric: angle between the
/// rendered force and the requested one. Baseline: the joint torques of the requested force are clipped one
/// by one at their limits, and give the force J^-T tau. Bound: 1 deg. In addition |J^T F| + |g| keeps every
/// torque limit, no force exceeds 200 N, and the whole force is rendered again within 50 ms of the moment
/// from which on the arm can hold it.
[[nodiscard]] FailureResult RunSaturation(const FailureSetting& setting);

}  // namespace osteon::studies
