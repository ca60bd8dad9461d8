#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "kinematics/spatial.h"

namespace osteon::simulation {

/// Position of p on the Morton (Z-order) curve through `box`, 21 bits per axis; points outside the box are
/// moved to its border.
[[nodiscard]] inline std::uint64_t MortonCode(const Vector3& p, const Eigen::AlignedBox3d& box) {
  constexpr double kCells = 2097152.0;  // 2^21
  const double side = box.sizes().maxCoeff();
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double t = side > 0.0 ? (p[axis] - box.min()[axis]) / side * kCells : 0.0;
    std::uint64_t x = static_cast<std::uint64_t>(std::clamp(t, 0.0, kCells - 1.0));
    // insert two zero bits between each bit and the next
    x = (x | x << 32) & 0x1f00000000ffffULL;
    x = (x | x << 16) & 0x1f0000ff0000ffULL;
    x = (x | x << 8) & 0x100f00f00f00f00fULL;
    x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
    x = (x | x << 2) & 0x1249249249249249ULL;
    code |= x << axis;
  }
  return code;
}

/// Sorts items along the Morton curve through `box`; equal codes keep their order. `point(item)` is an item's
/// place.
template <typename Item, typename PointOf>
void SortAlongMortonCurve(std::vector<Item>& items, const Eigen::AlignedBox3d& box, PointOf point) {
  std::vector<std::pair<std::uint64_t, std::size_t>> order(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = {MortonCode(point(items[i]), box), i};
  std::sort(order.begin(), order.end());
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const auto& [code, index] : order) sorted.push_back(items[index]);
  items = std::move(sorted);
}

}  // namespace osteon::simulation
