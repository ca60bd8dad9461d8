#pragma once

#include <vector>

#include "simulation/solids/solid.h"
#include "simulation/solids/tissue_map.h"

namespace osteon::simulation {

/// Sizes of a generated block.
struct BlockShape {
  double width_m{0.040};            ///< along x
  double depth_m{0.040};            ///< along y
  double height_m{0.040};           ///< along z
  std::vector<TissueLayer> layers;  ///< from the top down
  MaterialIndex core{0};            ///< material below the layers
};

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const BlockShape& shape);

/// A box whose edges are parallel to the axes of G. Its material is in layers parallel to the top face, with
/// the core below.
///
/// It represents a plate, a sawbone block or a test piece. The material depends only on the depth below the
/// top face, as if the block had been sawn out of a wider one; the sides have no shell.
class BoxSolid final : public Solid {
 public:
  /// @throws std::invalid_argument if the corners are not finite, a side is not 0.1 mm … 1 m long, or a
  /// layer's thickness is negative.
  BoxSolid(const Vector3& low_m, const Vector3& high_m, std::vector<TissueLayer> layers = {},
           MaterialIndex core = 0);

  /// The block with G's origin in the middle of its top face, +z up: it fills -height <= z <= 0.
  /// @throws std::invalid_argument as CheckShape does.
  explicit BoxSolid(const BlockShape& shape);

  /// The distance is exact inside and outside.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return box_; }

 private:
  Eigen::AlignedBox3d box_;
  std::vector<TissueLayer> layers_;
  MaterialIndex core_;
};

}  // namespace osteon::simulation
