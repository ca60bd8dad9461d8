#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "simulation/surface/surface_chunk.h"

namespace osteon::surface {

/// The volume that a ball sweeps on a straight path.
struct Capsule {
  Vec3 a_mm, b_mm;  ///< centres of the ball at both ends of the path
  float radius_mm{0.0F};
};

/// Sets values = max(values, radius - |node - axis|) for the nodes of a brick, limited to ±kFieldLimit. A
/// node's value is the maximum over all capsules, so any order of the capsules, in any batches, gives the
/// same bits.
/// @param first  position of the brick's node 0
void SweepBrick(std::int16_t* values, Vec3 first, float voxel_mm, const Capsule& capsule);

/// Depth of a point in a capsule [mm]: radius - |point - axis|; negative outside.
[[nodiscard]] float DepthIn(const Capsule& capsule, Vec3 point);

/// Selects the capsules that meet a brick, except those that cannot be the deepest at any of its nodes.
/// @param depths     depth of the brick's centre in each capsule (DepthIn)
/// @param reach_mm   a capsule with a depth of -reach_mm or less does not meet the brick
/// @param half_mm    half of the brick's diagonal
/// @param[out] kept  indices of the selected capsules
void SelectCapsules(std::span<const Capsule> capsules, std::span<const float> depths, float reach_mm,
                    float half_mm, std::vector<std::uint32_t>& kept);

}  // namespace osteon::surface
