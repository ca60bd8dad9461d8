#include "simulation/methods/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>

#include "base/check_range.h"
#include "base/parallel.h"
#include "simulation/methods/ball_bone.h"
#include "simulation/packing/ball_forest.h"

namespace osteon::simulation {
namespace {

constexpr double kMaxVoxels = 2147483648.0;  ///< 2^31

// Shape and material of a bone without an exact solid. A point is inside if it lies in a ball. Its material
// is that of the nearest mass point.
class UnionOfBalls {
 public:
  explicit UnionOfBalls(const Bone& bone)
      : forest_(bone.balls), points_(bone.points), tree_(AsBalls(bone.points)) {}

  [[nodiscard]] bool Holds(const Vector3& p_m) const { return forest_.Gap(p_m, 1e-9) <= 0.0; }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const {
    return NearestMaterial(points_, tree_, p_m);
  }

 private:
  BallForest forest_;
  const std::vector<MassPoint>& points_;
  LiveTree tree_;
};

// Box around the solid; without a solid, around the bone's balls.
Eigen::AlignedBox3d BoundsOf(const Bone& bone, const Solid* solid) {
  if (solid) return solid->Bounds();
  Eigen::AlignedBox3d box;
  for (const Ball& ball : bone.balls) {
    box.extend(Vector3(ball.center_m) - Vector3::Constant(ball.radius_m));
    box.extend(Vector3(ball.center_m) + Vector3::Constant(ball.radius_m));
  }
  return box;
}

}  // namespace

VoxelGrid::VoxelGrid(const Bone& bone, const Solid* solid, double voxel_m) : voxel_m_(voxel_m) {
  CheckRangeMm("voxel: edge", voxel_m, 0.01e-3, 5e-3);
  const Eigen::AlignedBox3d box = BoundsOf(bone, solid);
  if (box.isEmpty())
    throw std::invalid_argument("voxels: found a bone without balls and no solid, accepted either");
  double voxels = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double count = kBrick * std::ceil(std::max(1.0, box.sizes()[axis] / voxel_m - 1e-6) / kBrick);
    voxels *= count;
    if (voxels > kMaxVoxels) break;
    size_[axis] = static_cast<std::int32_t>(count);
    bricks_[axis] = size_[axis] / kBrick;
    blocks_[axis] = (size_[axis] + kBlock - 1) / kBlock;
  }
  if (voxels > kMaxVoxels)
    throw std::invalid_argument(
        fmt::format("voxels: found an edge of {:g} mm in a box of {:.3g} × {:.3g} × {:.3g} mm, accepted up "
                    "to 2^31 voxels",
                    voxel_m * 1e3, box.sizes().x() * 1e3, box.sizes().y() * 1e3, box.sizes().z() * 1e3));
  first_center_m_ = box.min() + Vector3::Constant(0.5 * voxel_m);
  const std::size_t bricks = static_cast<std::size_t>(bricks_[0]) * bricks_[1] * bricks_[2];
  words_.assign(bricks * 8, 0);
  brick_material_.assign(bricks, 0);
  mixed_at_.assign(bricks, 0);
  Fill(bone, solid);
  first_words_ = words_;
  CountVoxels();
  for (const std::uint32_t count : block_count_) first_count_ += count;
}

void VoxelGrid::Fill(const Bone& bone, const Solid* solid) {
  const std::unique_ptr<UnionOfBalls> balls = solid ? nullptr : std::make_unique<UnionOfBalls>(bone);
  const bool one_material = bone.materials.size() < 2;
  // distance from a brick's centre to the centre of its farthest voxel
  const double reach_m = 0.5 * std::sqrt(3.0) * (kBrick - 1) * voxel_m_;
  // for each brick: the materials of its voxels if there are several materials, otherwise empty
  std::vector<std::vector<MaterialIndex>> materials(brick_material_.size());
  const auto fill = [&](std::size_t begin, std::size_t end) {
    std::vector<MaterialIndex> found(512);  // materials of one brick's voxels
    for (std::size_t b = begin; b < end; ++b) {
      const auto bx = static_cast<std::int32_t>(b % bricks_[0]),
                 by = static_cast<std::int32_t>(b / bricks_[0] % bricks_[1]),
                 bz = static_cast<std::int32_t>(b / bricks_[0] / bricks_[1]);
      double depth_m = 0.0;  // depth of the brick's centre in the solid; 0 without a solid
      if (solid) {
        const Vector3 low = CenterOf({bx * kBrick, by * kBrick, bz * kBrick});
        depth_m = -solid->SignedDistance(low + Vector3::Constant(0.5 * (kBrick - 1) * voxel_m_));
        if (depth_m < -reach_m)
          continue;  // every voxel is in the air: a distance changes by at most the way between two points
      }
      bool first = true, several = false;
      for (std::int32_t z = 0; z < kBrick; ++z)
        for (int bit = 0; bit < 64; ++bit) {
          const Vector3 p = CenterOf({bx * kBrick + (bit & 7), by * kBrick + (bit >> 3), bz * kBrick + z});
          const bool in = depth_m > reach_m || (solid ? solid->SignedDistance(p) < 0.0 : balls->Holds(p));
          if (!in) continue;
          words_[b * 8 + z] |= std::uint64_t{1} << bit;
          if (one_material) continue;
          const MaterialIndex material = solid ? solid->MaterialAt(p) : balls->MaterialAt(p);
          if (first) {
            std::fill(found.begin(), found.end(), material);
            brick_material_[b] = material;
            first = false;
          }
          several = several || material != brick_material_[b];
          found[static_cast<std::size_t>(z) * 64 + bit] = material;
        }
      if (several) materials[b] = found;
    }
  };
  ParallelFor(brick_material_.size(), 0, fill, 64);
  for (std::size_t b = 0; b < materials.size(); ++b) {
    if (materials[b].empty()) continue;
    brick_material_[b] = kMixed;
    mixed_at_[b] = static_cast<std::uint32_t>(mixed_.size() / 512);
    mixed_.insert(mixed_.end(), materials[b].begin(), materials[b].end());
  }
}

void VoxelGrid::CountVoxels() {
  brick_count_.assign(brick_material_.size(), 0);
  block_count_.assign(static_cast<std::size_t>(blocks_[0]) * blocks_[1] * blocks_[2], 0);
  for (std::int32_t z = 0; z < bricks_[2]; ++z)
    for (std::int32_t y = 0; y < bricks_[1]; ++y)
      for (std::int32_t x = 0; x < bricks_[0]; ++x) {
        const std::size_t brick = BrickOf(x, y, z);
        int count = 0;
        for (int i = 0; i < 8; ++i) count += std::popcount(words_[brick * 8 + i]);
        brick_count_[brick] = static_cast<std::uint16_t>(count);
        block_count_[BlockOf(x / 8, y / 8, z / 8)] += static_cast<std::uint32_t>(count);
      }
}

MaterialIndex VoxelGrid::MaterialOf(const VoxelIndex& v) const {
  const std::size_t brick = BrickOf(v.x >> 3, v.y >> 3, v.z >> 3);
  if (brick_material_[brick] != kMixed) return brick_material_[brick];
  return mixed_[mixed_at_[brick] * std::size_t{512} + static_cast<std::size_t>((v.z & 7) * 64 + BitOf(v))];
}

void VoxelGrid::Delete(const VoxelIndex& v) {
  words_[WordOf(v)] &= ~(std::uint64_t{1} << BitOf(v));
  --brick_count_[BrickOf(v.x >> 3, v.y >> 3, v.z >> 3)];
  --block_count_[BlockOf(v.x >> 6, v.y >> 6, v.z >> 6)];
}

bool VoxelGrid::AnyBrickNear(const Vector3& p_m, double reach_m) const {
  // ForEachBrick returns false if a visit returned false, which the visit of the first brick found does
  return !ForEachBrick((p_m - first_center_m_) / voxel_m_, reach_m / voxel_m_, 0.0,
                       [](std::int32_t, std::int32_t, std::int32_t) { return false; });
}

void VoxelGrid::Save(CarvedState& state) const {
  state.cleared.clear();
  state.cleared.reserve(first_count_);
  for (std::size_t w = 0; w < words_.size(); ++w)
    for (std::uint64_t left = first_words_[w]; left != 0; left &= left - 1)
      state.cleared.push_back((words_[w] >> std::countr_zero(left) & 1u) != 0 ? 0 : 1);
}

void VoxelGrid::Load(const CarvedState& state) {
  if (!state.balls.empty() || state.cleared.size() != first_count_)
    throw std::invalid_argument("carved state: not of this bone");
  std::size_t i = 0;
  for (std::size_t w = 0; w < words_.size(); ++w) {
    words_[w] = first_words_[w];
    for (std::uint64_t left = first_words_[w]; left != 0; left &= left - 1)
      if (state.cleared[i++] != 0) words_[w] &= ~(left & -left);
  }
  CountVoxels();
}

}  // namespace osteon::simulation
