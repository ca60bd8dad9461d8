#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulation/bone.h"

namespace osteon::simulation {

/// Balls in a grid, to ask how far a point is from their union. A cell lists every ball within `margin_m` of
/// it.
class CoverIndex {
 public:
  CoverIndex(const Eigen::AlignedBox3d& box, double cell_m, double margin_m)
      : origin_(box.min()), cell_m_(cell_m), margin_m_(margin_m) {
    for (int axis = 0; axis < 3; ++axis)
      size_[axis] = static_cast<int>(std::floor(box.sizes()[axis] / cell_m)) + 1;
    cells_.resize(static_cast<std::size_t>(size_[0]) * size_[1] * size_[2]);
  }

  void Insert(const Ball& ball) {
    const Vector3 c = ball.center_m;
    const double reach = ball.radius_m + margin_m_;
    const auto low = CellOf(c - Vector3::Constant(reach)), high = CellOf(c + Vector3::Constant(reach));
    for (int z = low[2]; z <= high[2]; ++z)
      for (int y = low[1]; y <= high[1]; ++y)
        for (int x = low[0]; x <= high[0]; ++x) cells_[At({x, y, z})].push_back(ball);
  }

  /// Whether p lies within `gap_m` of some ball. @pre gap_m <= margin_m
  [[nodiscard]] bool Covers(const Vector3& p, double gap_m) const {
    const std::vector<Ball>& near = cells_[At(CellOf(p))];
    return std::any_of(near.begin(), near.end(), [&](const Ball& ball) {
      const double reach = ball.radius_m + gap_m;
      return (p - Vector3(ball.center_m)).squaredNorm() <= reach * reach;
    });
  }

  /// Distance from p to the union of the balls, negative inside some ball; margin_m where none is near.
  [[nodiscard]] double Gap(const Vector3& p) const {
    double gap = margin_m_;
    for (const Ball& ball : cells_[At(CellOf(p))])
      gap = std::min(gap, (p - Vector3(ball.center_m)).norm() - ball.radius_m);
    return gap;
  }

 private:
  [[nodiscard]] std::array<int, 3> CellOf(const Vector3& p) const {
    std::array<int, 3> cell{};
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] =
          std::clamp(static_cast<int>(std::floor((p[axis] - origin_[axis]) / cell_m_)), 0, size_[axis] - 1);
    return cell;
  }
  [[nodiscard]] std::size_t At(const std::array<int, 3>& c) const {
    return (static_cast<std::size_t>(c[2]) * size_[1] + c[1]) * size_[0] + c[0];
  }

  Vector3 origin_;
  double cell_m_;
  double margin_m_;
  std::array<int, 3> size_{};
  std::vector<std::vector<Ball>> cells_;
};

}  // namespace osteon::simulation
