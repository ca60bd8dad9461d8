#pragma once

#include <cstdint>
#include <vector>

#include "simulation/surface/dual_surface.h"

namespace osteon::surface {

/// The tissue at vertices, brick by brick: most bricks have one tissue, which 4³ places of the brick tell
/// when it is asked for first. Only in bricks of several tissues is the solid asked at each vertex (a
/// microsecond or two, for a mesh). A layer thinner than a third of a brick may be missed where it ends. One
/// thread.
class TissueBricks {
 public:
  /// @param at  of the solid; empty: tissue 0 everywhere
  TissueBricks(const BrickLayout& layout, MaterialAt at);

  /// @param p_mm  within a voxel of the brick
  [[nodiscard]] std::uint8_t At(BrickIndex brick, Vec3 p_mm);
  /// At of a brick, for ExtractChunk; valid as long as this.
  [[nodiscard]] MaterialAt OfBrick(BrickIndex brick) {
    return [this, brick](Vec3 p_mm) { return At(brick, p_mm); };
  }

 private:
  static constexpr std::uint8_t kUnknown = 0xff, kMixed = 0xfe;  // a material is below 128
  [[nodiscard]] std::uint8_t Sample(BrickIndex brick) const;

  BrickLayout layout_;
  MaterialAt at_;
  std::vector<std::uint8_t> tissue_;  // by brick
};

}  // namespace osteon::surface
