#include "simulation/bone/material_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace osteon::simulation {
namespace {

constexpr double kPointsPerCell = 4.0;  // average number of points in a cell
// Largest number of cells along the longest side. It is needed because a flat cloud of points has a box
// without volume.
constexpr double kMaxCellsAlong = 256.0;

}  // namespace

MaterialMap::MaterialMap(const Bone& bone) {
  if (bone.points.empty()) return;
  only_ = bone.points.front().material;
  if (std::ranges::all_of(bone.points, [&](const MassPoint& point) { return point.material == only_; }))
    return;
  Eigen::AlignedBox3d box;
  for (const MassPoint& point : bone.points) box.extend(Vector3(point.p_m));
  const Vector3 sizes = box.sizes();
  const double cell_volume_m3 = kPointsPerCell * box.volume() / static_cast<double>(bone.points.size());
  origin_m_ = box.min();
  side_m_ = std::max({std::cbrt(cell_volume_m3), sizes.maxCoeff() / kMaxCellsAlong, 1e-6});
  for (int axis = 0; axis < 3; ++axis)
    size_[static_cast<std::size_t>(axis)] = static_cast<std::int64_t>(std::floor(sizes[axis] / side_m_)) + 1;

  // counting sort by cell, which keeps the bone's order within each cell
  first_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]) + 1, 0);
  for (const MassPoint& point : bone.points) ++first_[IndexOf(CellOf(point.p_m)) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  points_.resize(bone.points.size());
  for (const MassPoint& point : bone.points)
    points_[next[IndexOf(CellOf(point.p_m))]++] = {.x = static_cast<float>(point.p_m.x),
                                                   .y = static_cast<float>(point.p_m.y),
                                                   .z = static_cast<float>(point.p_m.z),
                                                   .material = point.material};
}

MaterialMap::CellIndex MaterialMap::CellOf(const Vector3& p_m) const {
  CellIndex cell{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double along =
        (p_m[static_cast<Eigen::Index>(axis)] - origin_m_[static_cast<Eigen::Index>(axis)]) / side_m_;
    cell[axis] =
        static_cast<std::int64_t>(std::clamp(std::floor(along), 0.0, static_cast<double>(size_[axis] - 1)));
  }
  return cell;
}

std::size_t MaterialMap::IndexOf(const CellIndex& cell) const {
  return static_cast<std::size_t>((cell[2] * size_[1] + cell[1]) * size_[0] + cell[0]);
}

MaterialIndex MaterialMap::At(const Vector3& p_m) const {
  if (points_.empty()) return only_;
  const CellIndex middle = CellOf(p_m);
  double nearest_m2 = std::numeric_limits<double>::infinity();
  MaterialIndex material = only_;
  const auto visit = [&](const CellIndex& cell) {
    const std::size_t place = IndexOf(cell);
    for (std::uint32_t i = first_[place]; i < first_[place + 1]; ++i) {
      const double distance_m2 = (Vector3(points_[i].x, points_[i].y, points_[i].z) - p_m).squaredNorm();
      if (distance_m2 >= nearest_m2) continue;
      nearest_m2 = distance_m2;
      material = points_[i].material;
    }
  };
  // Visit shells of cells around the cell of the place. All points of shell n are at least n - 1 cell edges
  // away.
  const std::int64_t last = *std::ranges::max_element(size_);
  for (std::int64_t shell = 0; shell <= last; ++shell) {
    const double reach_m = static_cast<double>(shell - 1) * side_m_;
    if (shell > 0 && nearest_m2 <= reach_m * reach_m) break;
    const auto low = [&](std::size_t axis) { return std::max<std::int64_t>(middle[axis] - shell, 0); };
    const auto high = [&](std::size_t axis) { return std::min(middle[axis] + shell, size_[axis] - 1); };
    for (std::int64_t z = low(2); z <= high(2); ++z)
      for (std::int64_t y = low(1); y <= high(1); ++y) {
        // a row of cells in a face of the shell belongs to the shell as a whole; of any other row, only the
        // two end cells do
        const bool whole_row = std::abs(z - middle[2]) == shell || std::abs(y - middle[1]) == shell;
        const std::int64_t step = whole_row ? 1 : 2 * shell;
        for (std::int64_t x = middle[0] - shell; x <= middle[0] + shell; x += step)
          if (x >= 0 && x < size_[0]) visit({x, y, z});
      }
  }
  return material;
}

}  // namespace osteon::simulation
