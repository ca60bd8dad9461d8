#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Rotates a twist into the axes of another frame.
[[nodiscard]] Twist ExpressedIn(const Matrix3& R_AB, const Twist& V_B) OSTEON_RT;

[[nodiscard]] Twist Scaled(const Twist& V, double share) OSTEON_RT;

/// Displacement between two poses that are less than a degree apart: dp, and the rotation as a vector in W,
/// by the rotation's skew part (5e-5 too short at a degree).
[[nodiscard]] Twist SmallStep(const Pose& X_from, const Pose& X_to) OSTEON_RT;

/// f·v + t·w: power for a twist, work for a small step.
[[nodiscard]] double Power(const Wrench& F, const Twist& V) OSTEON_RT;

/// Velocity that leads from one pose to another within a time: the position by its difference, the rotation
/// by its logarithm.
[[nodiscard]] Twist TwistBetween(const Pose& X_before, const Pose& X, double dt_s) OSTEON_RT;

}  // namespace osteon::control
