#include "hil/operator/hand_spring.h"

namespace osteon::hil {

Wrench HandSpring::Pull(const Pose& X, const Twist& V, const Pose& X_target,
                        const Twist& V_target) const noexcept {
  const Vector3 turn = X.linear() * LogRotation(X.linear().transpose() * X_target.linear());
  return {.f = stiffness_N_per_m * (X_target.translation() - X.translation()) +
               damping_Ns_per_m * (V_target.v - V.v),
          .t = stiffness_Nm_per_rad * turn + damping_Nms_per_rad * (V_target.w - V.w)};
}

}  // namespace osteon::hil
