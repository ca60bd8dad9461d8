#pragma once

#include <string>

#include "kinematics/chain_params.h"

// Checks a chain's parameters at set-up.

namespace osteon::kinematics {

/// Checks a joint and its link. @param number from 1, as in A1 …; @param masses whether the link must have a
/// mass.
/// @throws std::invalid_argument "joint 3: length of its axis: found 0.9, accepted 1"
void CheckJoint(const RevoluteJoint& joint, int number, bool masses);

/// Checks a rigid body: mass not negative; inertia symmetric and physically possible (no principal moment
/// greater than the sum of the other two).
/// @param of  name of the body's owner, for the beginning of the error's text
/// @throws std::invalid_argument naming the value found and what is accepted.
void CheckInertia(const LinkInertia& body, const std::string& of);

/// Checks that a pose has a proper rotation. @throws std::invalid_argument naming the value found and what is
/// accepted, after `of`.
void CheckPose(const Pose& X, const std::string& of);

/// Checks a whole chain.
template <int N>
void CheckChain(const ChainParams<N>& chain) {
  for (int i = 0; i < N; ++i) CheckJoint(chain.joints[static_cast<std::size_t>(i)], i + 1, chain.has_masses);
  CheckPose(chain.X_LF, "flange");
}

}  // namespace osteon::kinematics
