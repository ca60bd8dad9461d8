#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "simulation/surface/surface_chunk.h"

namespace osteon::surface {

/// A field's values are signed distances in steps of voxel / 8192, limited to 3 voxels on either side of the
/// surface.
inline constexpr int kStepsOfVoxel = 8192;
inline constexpr float kBandVoxels = 3.0F;
inline constexpr std::int16_t kFieldLimit = static_cast<std::int16_t>(3 * kStepsOfVoxel);

/// Half of a brick's diagonal between its outermost nodes, in voxels.
inline constexpr float kHalfDiagonalVoxels = 0.5F * 7.0F * 1.7320508F;

/// Converts a distance to steps of the field, limited to ±kFieldLimit.
[[nodiscard]] inline std::int16_t ToFieldValue(double distance_mm, float voxel_mm) {
  const double steps = distance_mm * (kStepsOfVoxel / static_cast<double>(voxel_mm));
  return static_cast<std::int16_t>(
      std::lround(std::clamp(steps, -static_cast<double>(kFieldLimit), static_cast<double>(kFieldLimit))));
}

/// A distance field in bricks of 8³ nodes. A uniform brick, whose nodes are all at the same limit, stores no
/// values.
class BrickField {
 public:
  static constexpr std::int32_t kAllLow = -1;   ///< every node at -kFieldLimit
  static constexpr std::int32_t kAllHigh = -2;  ///< every node at +kFieldLimit

  BrickField() = default;
  BrickField(BrickIndex bricks, std::int32_t state) : slots_(bricks, state) {}

  [[nodiscard]] BrickIndex Count() const { return static_cast<BrickIndex>(slots_.size()); }
  /// State of a brick: kAllLow, kAllHigh, or a number >= 0 if the brick has values.
  [[nodiscard]] std::int32_t State(BrickIndex brick) const { return slots_[brick]; }
  [[nodiscard]] bool HasValues(BrickIndex brick) const { return slots_[brick] >= 0; }

  /// The 512 values of a brick; null if the brick is uniform.
  [[nodiscard]] const std::int16_t* Values(BrickIndex brick) const {
    return HasValues(brick) ? values_.data() + Offset(slots_[brick]) : nullptr;
  }
  [[nodiscard]] std::int16_t* Values(BrickIndex brick) {
    return HasValues(brick) ? values_.data() + Offset(slots_[brick]) : nullptr;
  }

  /// Whether a brick has the same values in both fields.
  [[nodiscard]] bool SameValues(const BrickField& other, BrickIndex brick) const {
    if (!HasValues(brick) || !other.HasValues(brick)) return slots_[brick] == other.slots_[brick];
    return std::equal(Values(brick), Values(brick) + kBrickNodes, other.Values(brick));
  }

  /// Gives a uniform brick values of its own, all at its limit, and returns them. Pointers that Values
  /// returned before become invalid.
  std::int16_t* MakeValues(BrickIndex brick);
  /// Makes a brick uniform and frees its values.
  void MakeUniform(BrickIndex brick, std::int32_t state);

  /// Memory that the field takes.
  [[nodiscard]] std::size_t Bytes() const {
    return slots_.size() * sizeof(std::int32_t) + values_.size() * sizeof(std::int16_t);
  }

 private:
  [[nodiscard]] static std::size_t Offset(std::int32_t slot) {
    return static_cast<std::size_t>(slot) * kBrickNodes;
  }

  std::vector<std::int32_t> slots_;   // by brick: kAllLow, kAllHigh, or its slot in values_
  std::vector<std::int16_t> values_;  // by slot: the 512 values of a brick
  std::vector<std::int32_t> free_;    // slots that no brick uses any more
  std::int32_t used_{0};              // number of slots that were ever used
};

}  // namespace osteon::surface
