#pragma once

#include "kinematics/chain_params.h"

// Bodies joined to one another: tool and sensor to the flange.

namespace osteon::kinematics {

/// Inertia about the origin of a point mass at p, along the same axes: what Steiner's theorem adds.
[[nodiscard]] inline Matrix3 PointInertia(double mass_kg, const Vector3& p_m) {
  return mass_kg * (p_m.squaredNorm() * Matrix3::Identity() - p_m * p_m.transpose());
}

/// The same body seen from frame A: centre and inertia turned, the centre moved. @param body_B  in B
[[nodiscard]] LinkInertia SeenFrom(const Pose& X_AB, const LinkInertia& body_B);

/// Two bodies of one frame as one. No mass at all: nothing.
[[nodiscard]] LinkInertia Joined(const LinkInertia& a, const LinkInertia& b);

/// The arm with a body on its flange, given in the flange's frame F: the last link carries it from now on. An
/// arm whose masses are not known stays as it is.
/// @throws std::invalid_argument where the body is none: naming the value found and what is accepted.
template <int N>
[[nodiscard]] ChainParams<N> WithPayload(const ChainParams<N>& chain, const LinkInertia& payload_F);

}  // namespace osteon::kinematics
