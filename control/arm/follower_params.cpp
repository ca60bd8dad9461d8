#include <algorithm>
#include <cmath>

#include "control/arm/arm_follower.h"

// The parameters of an arm's follower and of its bounds, from those of a loop.

namespace osteon::control {

template <int N>
kinematics::DifferentialInverseParams<N> DifferentialInverseParamsOf(const ServoParams& params) {
  kinematics::DifferentialInverseParams<N> motion;
  std::copy_n(params.joints.limits.begin(), N, motion.limits.begin());
  motion.position_margin_rad = params.joints.position_margin_rad;
  motion.speed_share = params.joints.speed_share;
  motion.acceleration_share = params.joint_acceleration_share;
  // The virtual tool's radius of gyration: the inverse kinematics weights 1 rad of rotation like this length
  // of translation.
  motion.turning_length_m =
      std::sqrt(params.admittance.inertia_kg_m2.mean() / params.admittance.mass_kg.mean());
  return motion;
}

template kinematics::DifferentialInverseParams<6> DifferentialInverseParamsOf<6>(const ServoParams&);
template kinematics::DifferentialInverseParams<7> DifferentialInverseParamsOf<7>(const ServoParams&);

safety::WorkspaceParams WorkspaceOf(const ServoParams& params) {
  safety::WorkspaceParams workspace = params.workspace;
  if (params.depth.acts && !params.depth.rides_on_bone) workspace.zones.push_back(ZoneOf(params.depth));
  return workspace;
}

}  // namespace osteon::control
