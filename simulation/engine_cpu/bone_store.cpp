#include "simulation/engine_cpu/bone_store.h"

#include <algorithm>

#include "simulation/engine_cpu/rounding.h"

namespace osteon::simulation::cpu {
namespace {

// Converts a length from metres to float millimetres, with the rounding of RoundToStored().
float ToMillimetres(double metres) { return static_cast<float>(metres * 1e3); }

// Returns the box of a ball [mm], enlarged by an allowance for the rounding of floats.
BoxTree::Box BoxAround(const float (&center)[3], float radius_mm) {
  BoxTree::Box box{};
  for (int a = 0; a < 3; ++a) {
    box.low[a] = center[a] - radius_mm - kListSlack_mm;
    box.high[a] = center[a] + radius_mm + kListSlack_mm;
  }
  return box;
}

// Number of blocks of eight for the balls. It is a whole number of clusters, so the last cluster may have
// empty blocks.
std::uint32_t BlocksFor(std::size_t balls) {
  return static_cast<std::uint32_t>((balls + BoxTree::kCluster - 1) / BoxTree::kCluster * 8);
}

}  // namespace

BoneStore::BoneStore(const Bone& bone, double layer_m, std::size_t max_child_blocks)
    : ball_count_(bone.balls.size()),
      first_child_block_(BlocksFor(ball_count_)),
      block_count_(first_child_block_),
      blocks_(first_child_block_ + max_child_blocks, first_child_block_) {
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(ball_count_);
  for (std::size_t i = 0; i < ball_count_; ++i) {
    PutBall(i, {.center_m = bone.balls[i].center_m, .radius_m = bone.balls[i].radius_m});
    float four[4];
    ReadFloats(i, four);
    max_radius_mm_ = std::max<double>(max_radius_mm_, four[3]);
    boxes.push_back(BoxAround({four[0], four[1], four[2]}, std::max(0.0f, four[3])));
  }
  ball_tree = BoxTree(boxes);
  TakePoints(bone, layer_m);
}

void BoneStore::TakePoints(const Bone& bone, double layer_m) {
  const std::size_t count = bone.points.size();
  // allocate room to read eight points at a time
  for (AlignedArray<float>& a : point_mm_) a = AlignedArray<float>(count);
  volume_m3_.resize(count), layer_area_m2_.resize(count), material_.resize(count);
  std::size_t materials = std::max<std::size_t>(1, bone.materials.size());
  for (const MassPoint& point : bone.points)
    materials = std::max<std::size_t>(materials, point.material + 1u);
  material_points_.assign(materials, 0), material_clusters_.assign(materials, 0);
  std::vector<std::size_t> last_cluster(materials, count);
  std::vector<BoxTree::Box> boxes;
  boxes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const MassPoint& point = bone.points[i];
    const Vector3 p = point.p_m;
    const float center[3] = {ToMillimetres(p.x()), ToMillimetres(p.y()), ToMillimetres(p.z())};
    for (int a = 0; a < 3; ++a) point_mm_[a][i] = center[a];
    volume_m3_[i] = 1e-9 * static_cast<float>(point.volume_m3 * 1e9);
    layer_area_m2_[i] = volume_m3_[i] / layer_m;
    material_[i] = point.material;
    const std::size_t m = point.material, cluster = i / BoxTree::kCluster;
    ++material_points_[m];
    if (last_cluster[m] != cluster) ++material_clusters_[m], last_cluster[m] = cluster;
    boxes.push_back(BoxAround(center, 0.0f));
  }
  point_tree = BoxTree(boxes);
  SetCleared(std::vector<std::uint8_t>(count, 0));
}

std::size_t BoneStore::MaxPointBlocks(std::size_t material) const {
  return material_points_[material] / 8 + material_clusters_[material];
}

void BoneStore::SetChildBlocks(std::uint32_t count) {
  const std::uint32_t end = first_child_block_ + count;
  for (std::uint32_t b = block_count_; b < end; ++b) blocks_[b] = BallBlock{};
  block_count_ = end;
}

BallState BoneStore::BallAt(std::size_t ball) const {
  float four[4];
  ReadFloats(ball, four);
  return {.center_m = 1e-3 * Vector3(four[0], four[1], four[2]), .radius_m = 1e-3 * four[3]};
}

void BoneStore::PutBall(std::size_t ball, const BallState& state) {
  const Vector3& c = state.center_m;
  const float four[4] = {ToMillimetres(c.x()), ToMillimetres(c.y()), ToMillimetres(c.z()),
                         ToMillimetres(state.radius_m)};
  WriteFloats(ball, four);
}

void BoneStore::ReadFloats(std::size_t ball, float* four) const {
  const BallBlock& b = blocks_[ball / 8];
  const std::size_t k = ball % 8;
  four[0] = b.x[k], four[1] = b.y[k], four[2] = b.z[k], four[3] = b.r[k];
}

void BoneStore::WriteFloats(std::size_t ball, const float* four) {
  BallBlock& b = blocks_[ball / 8];
  const std::size_t k = ball % 8;
  b.x[k] = four[0], b.y[k] = four[1], b.z[k] = four[2], b.r[k] = four[3];
}

bool BoneStore::AnyLeft(std::uint32_t first_block, std::uint32_t end_block) const {
  for (std::uint32_t b = first_block; b < end_block; ++b)
    for (const float r : blocks_[b].r)
      if (r > 0.0f) return true;
  return false;
}

void BoneStore::Clear(std::size_t i) {
  cleared_[i] = 1;
  --points_left_[i / BoxTree::kCluster];
}

void BoneStore::SetCleared(const std::vector<std::uint8_t>& cleared) {
  cleared_ = cleared;
  points_left_.assign(point_tree.cluster_count(), 0);
  for (std::size_t i = 0; i < cleared_.size(); ++i)
    points_left_[i / BoxTree::kCluster] += cleared_[i] != 0 ? 0 : 1;
}

}  // namespace osteon::simulation::cpu
