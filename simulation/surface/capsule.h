#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulation/surface/surface_chunk.h"

namespace osteon::surface {

/// What a ball sweeps on a straight way.
struct Capsule {
  Vec3 a_mm, b_mm;  ///< the ball's centre at both ends
  float radius_mm{0.0F};
};

/// values = max(values, radius - |node - axis|) for the nodes of a brick, limited.
/// @param first  the brick's node 0
/// Each node's value is a function of the node and the capsule alone, and max has no order: any order of
/// capsules, in any batches, gives the same bits.
void SweepBrick(std::int16_t* values, Vec3 first, float voxel_mm, const Capsule& capsule);

/// radius - |point - axis|, in mm.
[[nodiscard]] float DepthIn(const Capsule& capsule, Vec3 point);

/// Leaves out, of the capsules that meet a brick, those that cannot be the deepest at any of its nodes.
/// @param depths     of the brick's centre in each capsule (DepthIn)
/// @param reach_mm   depths below -reach_mm don't meet the brick
/// @param half_mm    half of the brick's diagonal
/// @param[out] kept  indices of the capsules that count
void SelectCapsules(std::span<const Capsule> capsules, std::span<const float> depths, float reach_mm,
                    float half_mm, std::vector<std::uint32_t>& kept);

}  // namespace osteon::surface
