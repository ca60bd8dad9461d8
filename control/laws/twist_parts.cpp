#include "control/laws/twist_parts.h"

namespace osteon::control {

Twist ExpressedIn(const Matrix3& R_AB, const Twist& V_B) OSTEON_RT {
  return {.v = R_AB * V_B.v, .w = R_AB * V_B.w};
}

Twist Scaled(const Twist& V, double share) OSTEON_RT { return {.v = share * V.v, .w = share * V.w}; }

Twist SmallStep(const Pose& X_from, const Pose& X_to) OSTEON_RT {
  const Matrix3 R = X_to.linear() * X_from.linear().transpose();
  return {.v = X_to.translation() - X_from.translation(),
          .w = 0.5 * Vector3(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1))};
}

double Power(const Wrench& F, const Twist& V) OSTEON_RT { return F.f.dot(V.v) + F.t.dot(V.w); }

Twist TwistBetween(const Pose& X_before, const Pose& X, double dt_s) OSTEON_RT {
  return {.v = (X.translation() - X_before.translation()) / dt_s,
          .w = LogRotation(X.linear() * X_before.linear().transpose()) / dt_s};
}

}  // namespace osteon::control
