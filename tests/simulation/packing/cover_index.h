#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone/bone.h"

// A fast search for the distance to many overlapping balls, for tests that measure a packing's gaps.

namespace osteon::simulation {

/// Grid index over balls, for a point's distance from their union. A cell lists the balls within `margin_m`
/// of it. A cell that lies entirely within one ball is marked as covered and keeps no list. The size of the
/// lists therefore grows with the union's surface, however much the balls overlap: 8 bytes an entry, 4 bytes
/// a cell.
class CoverIndex {
 public:
  /// @param box  region of the queries; the cells, of side cell_m, reach margin_m beyond it
  CoverIndex(const Eigen::AlignedBox3d& box, double cell_m, double margin_m)
      : origin_(box.min() - Vector3::Constant(margin_m)), cell_m_(cell_m), margin_m_(margin_m) {
    std::size_t cells = 1;
    for (int axis = 0; axis < 3; ++axis) {
      size_[axis] = static_cast<int>(std::floor((box.sizes()[axis] + 2.0 * margin_m) / cell_m)) + 1;
      cells *= static_cast<std::size_t>(size_[axis]);
    }
    first_.resize(cells, kNone);
  }

  void Insert(const Ball& ball) {
    const Vector3 c = ball.center_m;
    const double reach = ball.radius_m + margin_m_;
    std::array<int, 3> low{}, high{};
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::max(0, CellAlong(axis, c[axis] - reach));
      high[axis] = std::min(size_[axis] - 1, CellAlong(axis, c[axis] + reach));
    }
    const auto number = static_cast<std::uint32_t>(balls_.size());
    balls_.push_back(ball);
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) {
          std::uint32_t& first = first_[At({x, y, z})];
          if (first == kCovered) continue;
          // the cell's nearest and furthest points from the ball's centre
          const Vector3 from_center = origin_ + cell_m_ * Vector3(x + 0.5, y + 0.5, z + 0.5) - c;
          const Vector3 furthest = from_center.cwiseAbs().array() + 0.5 * cell_m_;
          if (furthest.squaredNorm() <= ball.radius_m * ball.radius_m) {
            first = kCovered;
            continue;
          }
          const Vector3 nearest = (from_center.cwiseAbs().array() - 0.5 * cell_m_).max(0.0);
          if (nearest.squaredNorm() > reach * reach) continue;
          entries_.push_back({.ball = number, .next = first});
          first = static_cast<std::uint32_t>(entries_.size() - 1);
        }
  }

  /// True if p lies within `gap_m` of some ball. @pre 0 <= gap_m <= margin_m
  [[nodiscard]] bool Covers(const Vector3& p, double gap_m) const { return Gap(p) <= gap_m; }

  /// Distance from p to the union of the balls, 0 or negative inside; at most margin_m.
  [[nodiscard]] double Gap(const Vector3& p) const {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) {
      cell[axis] = CellAlong(axis, p[axis]);
      if (cell[axis] < 0 || cell[axis] >= size_[axis]) return margin_m_;
    }
    std::uint32_t entry = first_[At(cell)];
    if (entry == kCovered) return 0.0;
    double gap = margin_m_;
    for (; entry != kNone; entry = entries_[entry].next) {
      const Ball& ball = balls_[entries_[entry].ball];
      gap = std::min(gap, (p - Vector3(ball.center_m)).norm() - ball.radius_m);
    }
    return gap;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff, kCovered = 0xfffffffe;
  struct Entry {
    std::uint32_t ball, next;
  };

  [[nodiscard]] int CellAlong(int axis, double x) const {
    return static_cast<int>(std::clamp(std::floor((x - origin_[axis]) / cell_m_), -1e9, 1e9));
  }
  [[nodiscard]] std::size_t At(const std::array<int, 3>& c) const {
    return (static_cast<std::size_t>(c[2]) * size_[1] + c[1]) * size_[0] + c[0];
  }

  Vector3 origin_;
  double cell_m_;
  double margin_m_;
  std::array<int, 3> size_{};
  std::vector<std::uint32_t> first_;  ///< first entry of each cell's list, or kNone, kCovered
  std::vector<Entry> entries_;
  std::vector<Ball> balls_;
};

}  // namespace osteon::simulation
