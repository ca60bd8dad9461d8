#pragma once

#include <cstdint>
#include <vector>

#include "simulation/surface/dual_surface.h"

namespace osteon::surface {

/// The tissue at vertices, brick by brick. At the first query of a brick, 4³ places in it are sampled: most
/// bricks have a single tissue. Only in bricks of several tissues is the solid queried at each vertex (a
/// microsecond or two, for a mesh). A layer thinner than a third of a brick may be missed near its end. Only
/// one thread may use the object.
class TissueBricks {
 public:
  /// @param at  the solid's tissue at a place; empty: tissue 0 everywhere
  TissueBricks(const BrickLayout& layout, MaterialAt at);

  /// Returns the tissue at a place. @param p_mm  in the brick, or at most a voxel outside
  [[nodiscard]] std::uint8_t At(BrickIndex brick, Vec3 p_mm);
  /// At() for one brick as a function, for ExtractChunk. It is valid as long as this object lives.
  [[nodiscard]] MaterialAt OfBrick(BrickIndex brick) {
    return [this, brick](Vec3 p_mm) { return At(brick, p_mm); };
  }

 private:
  // Entries of tissue_ for a brick that is not sampled yet, and for a brick with several tissues. A tissue's
  // number is below 128.
  static constexpr std::uint8_t kUnknown = 0xff, kMixed = 0xfe;
  // The brick's tissue, or kMixed if 4³ sampled places have several.
  [[nodiscard]] std::uint8_t Sample(BrickIndex brick) const;

  BrickLayout layout_;
  MaterialAt at_;
  std::vector<std::uint8_t> tissue_;  // by brick: a tissue, kUnknown or kMixed
};

}  // namespace osteon::surface
