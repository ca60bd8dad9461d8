#pragma once

#include "control/rt/marker.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The same velocity seen along other axes.
[[nodiscard]] inline Twist Turned(const Matrix3& R_AB, const Twist& V_B) OSTEON_RT {
  return {.v = R_AB * V_B.v, .w = R_AB * V_B.w};
}

[[nodiscard]] inline Twist Scaled(const Twist& V, double share) OSTEON_RT {
  return {.v = share * V.v, .w = share * V.w};
}

/// The way from one pose to another that is less than a degree away: dp, and the turn as a vector in W, by
/// the rotation's skew part (a turn of a degree is 5e-5 of it too short).
[[nodiscard]] inline Twist SmallStep(const Pose& X_from, const Pose& X_to) OSTEON_RT {
  const Matrix3 R = X_to.linear() * X_from.linear().transpose();
  return {.v = X_to.translation() - X_from.translation(),
          .w = 0.5 * Vector3(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1))};
}

/// f·v + t·w: power on a twist, work on a small step.
[[nodiscard]] inline double Power(const Wrench& F, const Twist& V) OSTEON_RT {
  return F.f.dot(V.v) + F.t.dot(V.w);
}

/// The velocity that leads from one pose to another within a time: p by its difference, the turn by its
/// logarithm.
[[nodiscard]] inline Twist TwistBetween(const Pose& X_before, const Pose& X, double dt_s) OSTEON_RT {
  return {.v = (X.translation() - X_before.translation()) / dt_s,
          .w = LogRotation(X.linear() * X_before.linear().transpose()) / dt_s};
}

}  // namespace osteon::control
