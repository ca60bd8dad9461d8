#pragma once

#include "kinematics/chain_params.h"

// Bodies joined to one another: tool and sensor to the flange.

namespace osteon::kinematics {

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
