#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// One child of a split ball: centre x relative to the parent's centre, and radius, both in radii of the
/// parent. |x| + radius < 1, so the child lies inside its parent.
struct SplitChild {
  Vector3 x{Vector3::Zero()};
  double radius{0.0};
};

/// Table of the overlapping children that replace a ball when a tool first touches it.
///
///     buried balls: K centres spread evenly over |x| <= 0.6      exposed balls: 3 K / 8 small ones below the
///     (Lloyd), each child as large as fits in, 1 - |x|           pole, the others as on the left
///              ______                                                     pole
///            /  o   o \                                                 o-o-o-o
///           | o (o) o  |    64 rotations, so that                     / o     o \     256 poles, turned to
///            \  o   o /     neighbours differ                        |  o (o) o  |    where no other ball
///              ------                                                 \    o    /     covers this one
///
/// Large overlapping children lose the least bone in a cut. At the rim, where a cut meets the bone's surface,
/// only small children fill the edge. The shape of a ball (its set of children in the table) depends on the
/// uncut packing only, so a ball is always split in the same way. Values are rounded to floats and radii are
/// reduced by a millionth, so that children stay inside their parents in single precision, too.
class SplitTemplate {
 public:
  static constexpr std::uint32_t kRotations = 64, kPoles = 256, kShapes = kRotations + kPoles;

  /// @throws std::invalid_argument if `children` is not 8 … 1024.
  explicit SplitTemplate(int children);

  [[nodiscard]] int children() const { return children_; }
  /// @param shape  0 … kShapes - 1;  @param k  0 … children() - 1
  [[nodiscard]] const SplitChild& child(std::uint32_t shape, int k) const {
    return table_[static_cast<std::size_t>(shape) * static_cast<std::size_t>(children_) +
                  static_cast<std::size_t>(k)];
  }
  /// All shapes, one after the other.
  [[nodiscard]] const std::vector<SplitChild>& table() const { return table_; }

 private:
  int children_;
  std::vector<SplitChild> table_;
};

/// Computes the shape of each ball of a packing. For an exposed ball: the pole nearest to the mean of the
/// directions in which no other ball covers its surface. For a buried ball: a rotation that follows from its
/// index. Balls of at most min_radius_m are never split, and get rotations without a search. The result does
/// not depend on the number of threads (0: one per core).
[[nodiscard]] std::vector<std::uint16_t> SplitShapes(std::span<const Ball> balls, double min_radius_m,
                                                     int threads = 0);

}  // namespace osteon::simulation
