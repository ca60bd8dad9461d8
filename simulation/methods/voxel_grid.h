#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Indices of a voxel in the grid.
struct VoxelIndex {
  std::int32_t x, y, z;
};

/// Bone as voxels, in G. A voxel is solid if its centre lies in the bone, and takes one bit. A brick has 8
/// voxels per side, a block 8 bricks per side. Bricks and blocks count their solid voxels, so a search around
/// a tool visits only bone near the tool's surface, neither the air in the cut cavity nor the rest of the
/// bone.
///
/// An 80 mm block of 0.1 mm voxels, 512 million of them, takes 64 MB for the voxels and as much again for the
/// materials and for the initial voxels.
class VoxelGrid {
 public:
  /// Voxelises the solid. If `solid` is null, voxelises the union of the bone's balls; each voxel then has
  /// the material of the nearest mass point.
  /// @throws std::invalid_argument if the edge is not 0.01 … 5 mm, the bone is empty, or there would be more
  ///   than 2^31 voxels.
  VoxelGrid(const Bone& bone, const Solid* solid, double voxel_m);

  [[nodiscard]] double voxel_m() const { return voxel_m_; }
  [[nodiscard]] double voxel_volume_m3() const { return voxel_m_ * voxel_m_ * voxel_m_; }
  /// Centre of a voxel, in G.
  [[nodiscard]] Vector3 CenterOf(const VoxelIndex& v) const {
    return first_center_m_ + voxel_m_ * Vector3(v.x, v.y, v.z);
  }
  /// Voxel whose cube contains the point; the indices may lie outside the grid.
  [[nodiscard]] VoxelIndex IndexOf(const Vector3& p_m) const {
    const Vector3 q = ((p_m - first_center_m_) / voxel_m_).cwiseMax(-1e9).cwiseMin(1e9);
    return {static_cast<std::int32_t>(std::floor(q.x() + 0.5)),
            static_cast<std::int32_t>(std::floor(q.y() + 0.5)),
            static_cast<std::int32_t>(std::floor(q.z() + 0.5))};
  }
  /// Whether a voxel is solid; false outside the grid.
  [[nodiscard]] bool IsSolid(const VoxelIndex& v) const {
    return Inside(v) && (words_[WordOf(v)] >> BitOf(v) & 1u) != 0;
  }
  /// True if the indices lie in the grid, whether the voxel is solid or not.
  [[nodiscard]] bool Inside(const VoxelIndex& v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < size_[0] && v.y < size_[1] && v.z < size_[2];
  }
  /// Index of a voxel in arrays over the whole grid: 0 … slots() - 1. @pre Inside(v).
  [[nodiscard]] std::size_t SlotOf(const VoxelIndex& v) const { return WordOf(v) * 64 + BitOf(v); }
  [[nodiscard]] std::size_t slots() const { return words_.size() * 64; }
  /// Material of a voxel. @pre the voxel is or was solid.
  [[nodiscard]] MaterialIndex MaterialOf(const VoxelIndex& v) const;
  /// Deletes a voxel: it is no longer solid. @pre IsSolid(v).
  void Delete(const VoxelIndex& v);
  /// Number of solid voxels at the start.
  [[nodiscard]] std::size_t first_count() const { return first_count_; }
  [[nodiscard]] const std::array<std::int32_t, 3>& size() const { return size_; }

  /// Calls visit(VoxelIndex, centre's squared distance from p [m²]) in ascending order for each solid voxel
  /// whose centre is nearer to p than `reach_m`, except in bricks that lie entirely nearer than `hollow_m`.
  /// The search ends if a visit returns false. A voxel may be deleted during its own visit. @returns false if
  /// a visit returned false
  template <typename Visit>
  bool ForEachSolidNear(const Vector3& p_m, double reach_m, double hollow_m, const Visit& visit) const;

  /// True if a brick with solid voxels comes nearer to p than `reach_m`. If false, no solid voxel is within
  /// reach.
  [[nodiscard]] bool AnyBrickNear(const Vector3& p_m, double reach_m) const;

  /// Writes into `state` which of the initial voxels are deleted.
  void Save(CarvedState& state) const;
  /// Deletes the voxels that are deleted in `state`, and restores all others.
  /// @throws std::invalid_argument if the state belongs to another grid.
  void Load(const CarvedState& state);

 private:
  static constexpr std::int32_t kBrick = 8, kBlock = 64;  ///< voxels per side

  /// Index of the brick at these coordinates, which count bricks.
  [[nodiscard]] std::size_t BrickOf(std::int32_t bx, std::int32_t by, std::int32_t bz) const {
    return (static_cast<std::size_t>(bz) * bricks_[1] + by) * bricks_[0] + bx;
  }
  /// Index of the voxel's word in words_. A word holds the 8 × 8 voxels of a brick that have the same z.
  [[nodiscard]] std::size_t WordOf(const VoxelIndex& v) const {
    return BrickOf(v.x >> 3, v.y >> 3, v.z >> 3) * 8 + (v.z & 7);
  }
  [[nodiscard]] static int BitOf(const VoxelIndex& v) { return (v.y & 7) << 3 | (v.x & 7); }
  /// Index of the block at these coordinates, which count blocks.
  [[nodiscard]] std::size_t BlockOf(std::int32_t x, std::int32_t y, std::int32_t z) const {
    return (static_cast<std::size_t>(z) * blocks_[1] + y) * blocks_[0] + x;
  }

  /// Squared distances, in voxels, from q to the nearest and the farthest centre of a cube of voxels.
  /// @param x, y, z  lowest voxel of the cube
  /// @param side  edge of the cube, in voxels
  [[nodiscard]] static std::array<double, 2> Range(const Vector3& q, std::int32_t x, std::int32_t y,
                                                   std::int32_t z, std::int32_t side) {
    double near = 0.0, far = 0.0;
    const std::int32_t low[3] = {x, y, z};
    for (int axis = 0; axis < 3; ++axis) {
      const double a = low[axis] - q[axis], b = q[axis] - (low[axis] + side - 1);
      const double out = std::max(0.0, std::max(a, b)), farthest = std::max(-a, -b);
      near += out * out;
      far += farthest * farthest;
    }
    return {near, far};
  }
  /// Calls visit(bx, by, bz) for each brick with solid voxels that comes nearer to q than `reach` and does
  /// not lie entirely nearer than `hollow`, all in voxels. Ends and returns false if a visit returns false.
  template <typename Visit>
  bool ForEachBrick(const Vector3& q, double reach, double hollow, const Visit& visit) const;

  /// Sets the solid voxels and their materials at the start.
  void Fill(const Bone& bone, const Solid* solid);
  /// Counts the solid voxels of each brick and block.
  void CountVoxels();

  double voxel_m_;
  Vector3 first_center_m_;
  std::array<std::int32_t, 3> size_{}, bricks_{}, blocks_{};
  std::vector<std::uint64_t> words_, first_words_;  ///< for each brick, one word for each z
  std::vector<std::uint16_t> brick_count_;
  std::vector<std::uint32_t> block_count_;
  std::vector<MaterialIndex> brick_material_;  ///< material of each brick; kMixed: of several materials
  std::vector<std::uint32_t> mixed_at_;        ///< for each brick: its place in mixed_, counted in bricks
  std::vector<MaterialIndex> mixed_;           ///< materials of the voxels of all mixed bricks
  std::size_t first_count_{0};
  static constexpr MaterialIndex kMixed = 0xff;
};

template <typename Visit>
bool VoxelGrid::ForEachBrick(const Vector3& q, double reach, double hollow, const Visit& visit) const {
  const double reach2 = reach * reach, hollow2 = hollow > 0.0 ? hollow * hollow : 0.0;
  std::array<std::int32_t, 3> low{}, high{};
  for (int axis = 0; axis < 3; ++axis) {
    const double a = std::ceil(q[axis] - reach), b = std::floor(q[axis] + reach);
    if (b < 0.0 || a > size_[axis] - 1 || a > b) return true;
    low[axis] = static_cast<std::int32_t>(std::max(0.0, a));
    high[axis] = static_cast<std::int32_t>(std::min(size_[axis] - 1.0, b));
  }
  const auto reached = [&](std::int32_t x, std::int32_t y, std::int32_t z, std::int32_t side) {
    const auto [near, far] = Range(q, x, y, z, side);
    return near < reach2 && far >= hollow2;
  };
  // X, Y, Z count blocks; x, y, z count bricks
  for (std::int32_t Z = low[2] / kBlock; Z <= high[2] / kBlock; ++Z)
    for (std::int32_t Y = low[1] / kBlock; Y <= high[1] / kBlock; ++Y)
      for (std::int32_t X = low[0] / kBlock; X <= high[0] / kBlock; ++X) {
        if (block_count_[BlockOf(X, Y, Z)] == 0 || !reached(X * kBlock, Y * kBlock, Z * kBlock, kBlock))
          continue;
        const auto from = [&](int axis, std::int32_t block) {
          return std::max(low[axis] / kBrick, block * 8);
        };
        const auto to = [&](int axis, std::int32_t block) {
          return std::min(high[axis] / kBrick, block * 8 + 7);
        };
        for (std::int32_t z = from(2, Z); z <= to(2, Z); ++z)
          for (std::int32_t y = from(1, Y); y <= to(1, Y); ++y)
            for (std::int32_t x = from(0, X); x <= to(0, X); ++x)
              if (brick_count_[BrickOf(x, y, z)] != 0 &&
                  reached(x * kBrick, y * kBrick, z * kBrick, kBrick) && !visit(x, y, z))
                return false;
      }
  return true;
}

template <typename Visit>
bool VoxelGrid::ForEachSolidNear(const Vector3& p_m, double reach_m, double hollow_m,
                                 const Visit& visit) const {
  const Vector3 q = (p_m - first_center_m_) / voxel_m_;
  const double reach = reach_m / voxel_m_, reach2 = reach * reach;
  return ForEachBrick(q, reach, hollow_m / voxel_m_, [&](std::int32_t bx, std::int32_t by, std::int32_t bz) {
    const std::uint64_t* words = &words_[BrickOf(bx, by, bz) * 8];
    for (std::int32_t z = 0; z < kBrick; ++z) {
      const double dz = bz * kBrick + z - q.z();
      if (dz * dz >= reach2) continue;
      for (std::uint64_t left = words[z]; left != 0; left &= left - 1) {
        const int bit = std::countr_zero(left);
        const VoxelIndex v{bx * kBrick + (bit & 7), by * kBrick + (bit >> 3), bz * kBrick + z};
        const double dx = v.x - q.x(), dy = v.y - q.y();
        const double distance2 = dx * dx + dy * dy + dz * dz;
        if (distance2 < reach2 && !visit(v, distance2 * voxel_m_ * voxel_m_)) return false;
      }
    }
    return true;
  });
}

}  // namespace osteon::simulation
