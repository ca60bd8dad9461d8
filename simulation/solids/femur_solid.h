#pragma once

#include "simulation/solids/mesh_solid.h"

namespace osteon::simulation {

/// Sizes of the generated upper femur, its neck sawn off. Proportions are from memory; the shaft is within
/// values reported for adults (outer diameter 25 to 30 mm, canal 10 to 15 mm at its narrowest).
struct FemurShape {
  double length_m{0.110};         ///< from the saw cut down
  double flare_m{0.065};          ///< height over which the shaft widens to the cut
  double shaft_radius_m{0.0138};  ///< mean of the two outer half axes of the oval
  double top_radius_m{0.0225};    ///< the same mean at the saw cut
  double oval_ratio{1.12};        ///< half axis along x (inwards) / half axis along y
  /// Displacement of the outline's centre from the canal's axis at the saw cut, along +x
  double medial_shift_m{0.006};
  double shaft_wall_m{0.0055};  ///< thickness of the cortical wall along the axes of the oval
  double top_wall_m{0.0020};    ///< thickness of the cortical wall at the saw cut
  /// Smallest thickness of the cancellous bone between wall and marrow (along y)
  double shaft_lining_m{0.0018};
  double top_marrow_radius_m{0.004};  ///< radius of the marrow at the saw cut; cancellous bone surrounds it
};

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const FemurShape& shape);

/// The upper end of a femur after the neck's resection, in G: origin where the canal's axis meets the saw
/// cut, +z up out of the canal, +x inwards (medial).
///
/// Outside: a tube of oval rings, as a mesh; distances are exact for that mesh. The tissue depends on the
/// place: cortical outside an oval whose half axes are those of the outline less the wall, marrow in a round
/// canal about the z axis, cancellous bone between both. Both ends are saw cuts without a shell.
class FemurSolid final : public Solid {
 public:
  enum Tissue : MaterialIndex { kCortical = 0, kCancellous = 1, kMarrow = 2 };

  /// @throws std::invalid_argument as CheckShape does.
  explicit FemurSolid(const FemurShape& shape);

  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override {
    return mesh_.NearestSurface(p_m);
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return mesh_.Bounds(); }

  /// Section at one height: the outer and the inner oval of the wall, both centred at (shift, 0) with half
  /// axes along x and y, and the marrow's circle about the z axis.
  struct Section {
    double shift_m, outer_x_m, outer_y_m, wall_m, marrow_m;
  };
  [[nodiscard]] Section At(double z_m) const;

 private:
  FemurShape shape_;
  MeshSolid mesh_;
};

/// The femur's outer surface.
/// @throws std::invalid_argument as CheckShape does.
[[nodiscard]] TriangleMesh FemurMesh(const FemurShape& shape);

}  // namespace osteon::simulation
