#pragma once

#include <array>
#include <cstddef>

#include "kinematics/serial_chain.h"

namespace osteon::kinematics {

/// dJ/dt for the point of the flange that is now at p_B and moves with the flange, at joint velocities qd
/// [rad/s]. The rows are v, then w, in B. Exact up to rounding.
///
/// A column of J is (z × (p - p_i), z) for a joint with axis z and origin p_i. With w the link's angular
/// velocity, v the velocity of p_i and v_p that of p, the column's rate is (zd × (p - p_i) + z × (v_p - v),
/// zd), where zd = w × z.
template <int N>
[[nodiscard]] JacobianN<N> JacobianDot(const typename SerialChain<N>::Posture& posture,
                                       const JointVectorN<N>& qd, const Vector3& p_B) {
  // velocities along the chain, outwards
  std::array<Vector3, static_cast<std::size_t>(N)> w, v;
  Vector3 w_link = Vector3::Zero(), v_link = Vector3::Zero(), p_link = Vector3::Zero();
  for (std::size_t i = 0; i < N; ++i) {
    v_link += w_link.cross(posture.p_BL[i] - p_link);
    w_link += qd[static_cast<int>(i)] * posture.axis_B(static_cast<int>(i));
    p_link = posture.p_BL[i];
    w[i] = w_link;
    v[i] = v_link;
  }
  const Vector3 v_point = v_link + w_link.cross(p_B - p_link);

  JacobianN<N> J_dot;
  for (std::size_t i = 0; i < N; ++i) {
    const Vector3 axis = posture.axis_B(static_cast<int>(i)), axis_dot = w[i].cross(axis);
    J_dot.col(static_cast<int>(i)).template head<3>() =
        axis_dot.cross(p_B - posture.p_BL[i]) + axis.cross(v_point - v[i]);
    J_dot.col(static_cast<int>(i)).template tail<3>() = axis_dot;
  }
  return J_dot;
}

}  // namespace osteon::kinematics
