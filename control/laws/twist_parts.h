#pragma once

#include "base/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// Rotates a twist into the axes of another frame.
[[nodiscard]] Twist ExpressedIn(const Matrix3& R_AB, const Twist& V_B) OSTEON_RT;

/// The twist multiplied by a factor.
[[nodiscard]] Twist Scaled(const Twist& V, double share) OSTEON_RT;

/// Displacement between two poses that differ by less than a degree: the difference of the positions, and the
/// rotation as a vector in W. The rotation vector is taken from the skew part of the rotation matrix: at one
/// degree it is too short by a relative error of 5e-5.
[[nodiscard]] Twist SmallStep(const Pose& X_from, const Pose& X_to) OSTEON_RT;

/// f·v + t·w: the power of a wrench at a twist, or its work over a small displacement (SmallStep).
[[nodiscard]] double Power(const Wrench& F, const Twist& V) OSTEON_RT;

/// Velocity that leads from one pose to another within dt_s: the difference of the positions and the
/// logarithm of the relative rotation, both divided by dt_s.
[[nodiscard]] Twist TwistBetween(const Pose& X_before, const Pose& X, double dt_s) OSTEON_RT;

}  // namespace osteon::control
