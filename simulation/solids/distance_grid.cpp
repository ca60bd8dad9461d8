#include "simulation/solids/distance_grid.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace osteon::simulation {
namespace {

constexpr double kOutside = -1.0;  // depth that is stored for a node outside the solid [m]
// nodes along the edge of a block; one query may show that the whole block is outside
constexpr int kBlock = 6;

}  // namespace

DistanceGrid::DistanceGrid(const Solid& solid, int nodes_along, int threads) {
  const Eigen::AlignedBox3d box = solid.Bounds();
  spacing_m_ = box.sizes().maxCoeff() / nodes_along;
  std::array<int, 3> blocks{};
  for (int axis = 0; axis < 3; ++axis) {
    blocks[axis] = static_cast<int>(std::floor(box.sizes()[axis] / spacing_m_)) / kBlock + 1;
    count_[axis] = blocks[axis] * kBlock;
  }
  low_m_ = box.center() - 0.5 * spacing_m_ * Vector3(count_[0] - 1, count_[1] - 1, count_[2] - 1);
  depth_m_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2], kOutside);

  const double half_diagonal = 0.5 * std::sqrt(3.0) * (kBlock - 1) * spacing_m_;
  const auto fill = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const int x0 = kBlock * static_cast<int>(i % blocks[0]);
      const int y0 = kBlock * static_cast<int>(i / blocks[0] % blocks[1]);
      const int z0 = kBlock * static_cast<int>(i / blocks[0] / blocks[1]);
      const Vector3 center = Node(x0, y0, z0) + Vector3::Constant(0.5 * (kBlock - 1) * spacing_m_);
      if (solid.SignedDistance(center) > half_diagonal) continue;
      for (int z = z0; z < z0 + kBlock; ++z)
        for (int y = y0; y < y0 + kBlock; ++y)
          for (int x = x0; x < x0 + kBlock; ++x) depth_m_[At(x, y, z)] = -solid.SignedDistance(Node(x, y, z));
    }
  };
  ParallelFor(static_cast<std::size_t>(blocks[0]) * blocks[1] * blocks[2], threads, fill, 8);
}

double DistanceGrid::LowerBound(const Vector3& p_m) const {
  std::array<int, 3> at{};
  for (int axis = 0; axis < 3; ++axis) {
    const double t = std::floor((p_m[axis] - low_m_[axis]) / spacing_m_ + 0.5);
    if (!(t >= 0.0 && t < count_[axis])) return kOutside;
    at[axis] = static_cast<int>(t);
  }
  const double depth = depth_m_[At(at[0], at[1], at[2])];
  // subtract a picometre, because rounding must not make the bound too large
  return depth - (p_m - Node(at[0], at[1], at[2])).norm() - 1e-12;
}

std::vector<Vector3> DistanceGrid::LocalMaxima() const {
  std::vector<Vector3> maxima;
  for (int z = 0; z < count_[2]; ++z)
    for (int y = 0; y < count_[1]; ++y)
      for (int x = 0; x < count_[0]; ++x) {
        const double depth = depth_m_[At(x, y, z)];
        if (depth <= 0.0) continue;
        bool is_maximum = true;
        for (int i = 0; i < 27 && is_maximum; ++i) {
          const int a = x + i % 3 - 1, b = y + i / 3 % 3 - 1, c = z + i / 9 - 1;
          if (a < 0 || b < 0 || c < 0 || a >= count_[0] || b >= count_[1] || c >= count_[2]) continue;
          is_maximum = depth_m_[At(a, b, c)] <= depth;
        }
        if (is_maximum) maxima.push_back(Node(x, y, z));
      }
  return maxima;
}

}  // namespace osteon::simulation
