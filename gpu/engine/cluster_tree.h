#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "gpu/shaders/layout.h"

namespace osteon::gpu {

/// A tree of bounding boxes. Level 0 has a box around each cluster of 64 consecutive balls or points of a
/// list, which is sorted along a space-filling curve. Each box of a higher level encloses eight boxes of the
/// level below, up to one root. The tree is built once: balls only shrink within their former volume, so
/// every box stays valid.
///
///     level 2        [                 0                 ]
///     level 1        [ 0 ][ 1 ] …            8 children each
///     level 0        clusters of 64 items
class ClusterTree {
 public:
  ClusterTree() = default;
  /// @param items  centres and radii [mm]
  explicit ClusterTree(std::span<const vec4> items);

  [[nodiscard]] std::size_t cluster_count() const { return levels_.empty() ? 0 : levels_.front().size(); }

  /// Calls visit(cluster) in ascending order for every cluster whose box a ball of `radius_mm` may meet on
  /// its path from a to b. Conservative: clusters whose boxes are near the path but not met may be included.
  template <class Visit>
  void VisitOverlapping(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float radius_mm,
                        Visit visit) const {
    if (levels_.empty()) return;
    Descend(levels_.size() - 1, 0, Sweep(a, b, radius_mm), visit);
  }

  /// A ball that moves from a to b.
  class Sweep {
   public:
    Sweep(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float radius_mm)
        : box_(a.cwiseMin(b), a.cwiseMax(b)),
          middle_(0.5f * (a + b)),
          radius_mm_(radius_mm + kRounding_mm),
          half_mm_(0.5f * (b - a).norm()) {}
    /// True if the ball may meet the box on its path; conservative.
    [[nodiscard]] bool Overlaps(const Eigen::AlignedBox3f& other) const {
      const float reach = radius_mm_ + half_mm_;
      return other.squaredExteriorDistance(box_) <= radius_mm_ * radius_mm_ &&
             other.squaredExteriorDistance(middle_) <= reach * reach;
    }

   private:
    static constexpr float kRounding_mm = 1e-3f;  // floats of 100 mm round to 8e-6 mm
    Eigen::AlignedBox3f box_;                     // box around the path of the ball's centre
    Eigen::Vector3f middle_;                      // middle of the path
    float radius_mm_, half_mm_;  // the ball's radius plus kRounding_mm; half the path's length
  };
  /// True if the sweep may meet the box of one cluster.
  [[nodiscard]] bool Overlaps(const Sweep& sweep, uint cluster) const {
    return sweep.Overlaps(levels_.front()[cluster]);
  }

 private:
  static constexpr std::size_t kChildren = 8;

  // Visits the clusters under one box that the sweep may meet.
  template <class Visit>
  void Descend(std::size_t level, std::size_t node, const Sweep& sweep, Visit& visit) const {
    if (!sweep.Overlaps(levels_[level][node])) return;
    if (level == 0) {
      visit(static_cast<uint>(node));
      return;
    }
    const std::size_t end = std::min(levels_[level - 1].size(), (node + 1) * kChildren);
    for (std::size_t child = node * kChildren; child < end; ++child) Descend(level - 1, child, sweep, visit);
  }

  std::vector<std::vector<Eigen::AlignedBox3f>> levels_;  // clusters first, one box last
};

}  // namespace osteon::gpu
