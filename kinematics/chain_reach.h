#pragma once

#include "base/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::kinematics {

/// Upper bound of the distance of the flange's origin from each joint's axis in any posture [m]: the sum of
/// the chain's lengths from the joint to the flange.
///
///     R_i = |p_(i+1)| + … + |p_N| + |p_LF|,   p_j: translation of joint j's X_PJ
///
/// So a point at a distance c from the flange's origin moves by at most R_i + c per radian of joint i. The
/// same holds for a point on an earlier link at a distance c from that link's origin.
template <int N>
[[nodiscard]] JointVectorN<N> ReachBeyond(const ChainParams<N>& chain) OSTEON_RT {
  JointVectorN<N> reach_m;
  double beyond_m = chain.X_LF.translation().norm();
  for (int i = N - 1; i >= 0; --i) {
    reach_m[i] = beyond_m;
    beyond_m += chain.joints[static_cast<std::size_t>(i)].X_PJ.translation().norm();
  }
  return reach_m;
}

}  // namespace osteon::kinematics
