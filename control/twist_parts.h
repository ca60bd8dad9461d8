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

/// The velocity that leads from one pose to another within a time: p by its difference, the turn by its
/// logarithm.
[[nodiscard]] inline Twist TwistBetween(const Pose& X_before, const Pose& X, double dt_s) OSTEON_RT {
  return {.v = (X.translation() - X_before.translation()) / dt_s,
          .w = LogRotation(X.linear() * X_before.linear().transpose()) / dt_s};
}

}  // namespace osteon::control
