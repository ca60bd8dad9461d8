#pragma once

#include "kinematics/chain_params.h"

// Combines the mass properties of rigid bodies, such as tool, sensor and flange.

namespace osteon::kinematics {

/// Inertia about the origin of a point mass at p, along the same axes (Steiner's term).
[[nodiscard]] inline Matrix3 PointInertia(double mass_kg, const Vector3& p_m) {
  return mass_kg * (p_m.squaredNorm() * Matrix3::Identity() - p_m * p_m.transpose());
}

/// Expresses a body in frame A: centre and inertia rotated, the centre moved. @param body_B  the body in
/// frame B
[[nodiscard]] LinkInertia SeenFrom(const Pose& X_AB, const LinkInertia& body_B);

/// Combines two bodies given in the same frame. Zero if neither has mass.
[[nodiscard]] LinkInertia Joined(const LinkInertia& a, const LinkInertia& b);

/// Adds a body, given in the flange's frame F, to the arm's last link. No effect if the masses are unknown.
/// @throws std::invalid_argument if the body is not a valid one, naming the value found and what is accepted.
template <int N>
[[nodiscard]] ChainParams<N> WithPayload(const ChainParams<N>& chain, const LinkInertia& payload_F);

}  // namespace osteon::kinematics
