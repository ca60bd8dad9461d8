#pragma once

#include <cstdint>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine_cpu/aligned_array.h"
#include "simulation/engine_cpu/box_tree.h"
#include "simulation/engine_cpu/pass_data.h"
#include "simulation/removal/split_ball.h"

namespace osteon::simulation::cpu {

/// The present state of the bone: balls in blocks of eight (the bone's own, then the children of split
/// balls), mass points, and a box tree over each.
class BoneStore {
 public:
  /// @param layer_m  depth of the engaged layer
  /// @param max_child_blocks  largest number of blocks of children
  BoneStore(const Bone& bone, double layer_m, std::size_t max_child_blocks);

  // ---- balls; a ball's index is 8 · block + lane
  [[nodiscard]] std::size_t ball_count() const { return ball_count_; }
  [[nodiscard]] BallBlock* blocks() { return blocks_.data(); }
  [[nodiscard]] const BallBlock* blocks() const { return blocks_.data(); }
  [[nodiscard]] std::uint32_t block_count() const { return block_count_; }
  /// The first block of children.
  [[nodiscard]] std::uint32_t first_child_block() const { return first_child_block_; }
  /// Sets how many blocks of children are in use, from first_child_block() on; new blocks are empty.
  void SetChildBlocks(std::uint32_t count);
  [[nodiscard]] BallState BallAt(std::size_t ball) const;
  void PutBall(std::size_t ball, const BallState& state);
  /// These functions read and write a ball's x y z r [mm], the format of CarvedState.
  void ReadFloats(std::size_t ball, float* four) const;
  void WriteFloats(std::size_t ball, const float* four);
  [[nodiscard]] float RadiusOf(std::size_t ball) const { return blocks_[ball / 8].r[ball % 8]; }
  /// Sets a ball's radius to zero.
  void Remove(std::size_t ball) { blocks_[ball / 8].r[ball % 8] = 0.0f; }
  /// Whether any ball of these blocks has a radius above zero.
  [[nodiscard]] bool AnyLeft(std::uint32_t first_block, std::uint32_t end_block) const;
  [[nodiscard]] double max_radius_mm() const { return max_radius_mm_; }

  // ---- mass points
  [[nodiscard]] std::size_t point_count() const { return cleared_.size(); }
  [[nodiscard]] std::size_t material_count() const { return material_points_.size(); }
  /// Upper bound of the number of blocks of eight in a neighbour list of a material's points.
  [[nodiscard]] std::size_t MaxPointBlocks(std::size_t material) const;
  [[nodiscard]] const float* point_mm(int axis) const { return point_mm_[axis].data(); }
  [[nodiscard]] double volume_m3(std::size_t i) const { return volume_m3_[i]; }
  [[nodiscard]] double layer_area_m2(std::size_t i) const { return layer_area_m2_[i]; }
  [[nodiscard]] MaterialIndex material(std::size_t i) const { return material_[i]; }
  [[nodiscard]] bool is_cleared(std::size_t i) const { return cleared_[i] != 0; }
  /// Marks a mass point as removed.
  void Clear(std::size_t i);
  /// Number of points of a cluster that are not cleared.
  [[nodiscard]] std::uint32_t PointsLeft(std::uint32_t cluster) const { return points_left_[cluster]; }
  [[nodiscard]] const std::vector<std::uint8_t>& cleared() const { return cleared_; }
  /// Sets for each mass point whether it is removed.
  void SetCleared(const std::vector<std::uint8_t>& cleared);

  BoxTree ball_tree, point_tree;

 private:
  // Copies the bone's mass points and builds their tree.
  void TakePoints(const Bone& bone, double layer_m);

  std::size_t ball_count_;
  std::uint32_t first_child_block_, block_count_;
  AlignedArray<BallBlock> blocks_;
  double max_radius_mm_{0.0};
  AlignedArray<float> point_mm_[3];
  std::vector<double> volume_m3_, layer_area_m2_;
  std::vector<MaterialIndex> material_;
  // for each material: number of its points, and of clusters that have such points
  std::vector<std::size_t> material_points_, material_clusters_;
  std::vector<std::uint8_t> cleared_;
  std::vector<std::uint32_t> points_left_;  // points not cleared, for each cluster
};

}  // namespace osteon::simulation::cpu
