#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/bone/bone.h"

namespace osteon::simulation {

/// Finds the material at a place of a bone: the material of the nearest mass point, including cleared points.
/// All engines look up the materials of contacts here, so that they agree.
///
/// Holds a uniform grid of the points, four to a cell on average, 16 bytes per point. If all points have one
/// material, the grid is empty. A look-up on the bone's surface visits 27 cells.
class MaterialMap {
 public:
  explicit MaterialMap(const Bone& bone);

  /// Material at a place in G. If several points are equally near, the same one is always chosen. 0 if the
  /// bone has no mass points.
  [[nodiscard]] MaterialIndex At(const Vector3& p_m) const;

 private:
  struct Point {
    float x, y, z;  ///< [m]
    MaterialIndex material;
  };
  using CellIndex = std::array<std::int64_t, 3>;

  [[nodiscard]] CellIndex CellOf(const Vector3& p_m) const;  // for a place outside the grid: the nearest cell
  [[nodiscard]] std::size_t IndexOf(const CellIndex& cell) const;

  MaterialIndex only_{0};  ///< if the grid is empty: material of all points
  Vector3 origin_m_{Vector3::Zero()};
  double side_m_{0.0};                ///< edge of a cell
  CellIndex size_{0, 0, 0};           ///< cells along each axis
  std::vector<std::uint32_t> first_;  ///< index in points_ of each cell's first point; then the end
  std::vector<Point> points_;         ///< sorted by cell
};

}  // namespace osteon::simulation
