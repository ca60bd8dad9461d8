#pragma once

#include "control/rt/marker.h"
#include "kinematics/chain_params.h"

namespace osteon::kinematics {

/// How far from each joint's axis the flange's origin can be, at most, whatever the others do: the lengths of
/// the chain beyond it [m].
///
///     R_i = |p_(i+1)| + … + |p_N| + |p_LF|
///
/// A point that is c from the flange's origin then moves by R_i + c per radian of joint i at most; so does
/// one on a link before it that is c from the link's origin.
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
