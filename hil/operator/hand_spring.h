#pragma once

#include "kinematics/spatial.h"

namespace osteon::hil {

/// The spring and damper by which an operator holds the tool.
struct HandSpring {
  double stiffness_N_per_m{2000.0};
  double damping_Ns_per_m{60.0};
  double stiffness_Nm_per_rad{20.0};
  double damping_Nms_per_rad{0.8};

  /// Wrench that the hand exerts at a point of the tool, in W. Poses at the point, velocities of the point,
  /// all in W.
  [[nodiscard]] Wrench Pull(const Pose& X, const Twist& V, const Pose& X_target,
                            const Twist& V_target) const noexcept;
};

}  // namespace osteon::hil
