#pragma once

#include <random>

#include <kdl/chain.hpp>

#include "kinematics/chain_params.h"

// Arms for tests, and the same arms as KDL chains.

namespace osteon::kinematics {

/// LBR iiwa 14 R820 as in lbr_description: joint origins that are not all on the arm's centre line, axes
/// along z, y, z, -y, z, y, z.
[[nodiscard]] ChainParams<7> Iiwa14Chain();

/// KR 6 R900-2 from the joint origins of kuka_experimental's kr6r900sixx description. No masses.
[[nodiscard]] ChainParams<6> Kr6R900();

/// A random arm: origins within 0.3 m, any rotations and axes, masses of bodies of the arm's size, rotors,
/// friction, and any flange pose.
template <int N>
[[nodiscard]] ChainParams<N> RandomChain(std::mt19937_64& random);

/// @returns the chain's joints as KDL's segments, and its flange as a last segment without a joint. KDL
/// expects a link's inertia in the frame of the segment's tip. Here that tip is the joint, so it is the same
/// frame as in ChainParams.
template <int N>
[[nodiscard]] KDL::Chain KdlChain(const ChainParams<N>& params);

/// Uniform in ±range for each joint.
template <int N>
[[nodiscard]] JointVectorN<N> RandomJoints(std::mt19937_64& random, double range);

}  // namespace osteon::kinematics
