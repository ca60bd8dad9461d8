#pragma once

#include "simulation/solids/mesh_solid.h"

namespace osteon::simulation {

/// Sizes of the generated femoral head with its neck: within values reported for adults (head 40 to 54 mm,
/// neck 26 to 36 mm across), from memory.
struct FemoralHeadShape {
  double head_radius_m{0.024};
  double neck_radius_m{0.015};
  double neck_length_m{0.045};  ///< from the head's centre to the saw cut across the neck
  double neck_tilt_rad{0.611};  ///< angle between the neck and -z, towards +x: 35 degrees
  double cartilage_m{0.0};      ///< thickness, the same everywhere; 0: worn off
  double cortical_m{0.0015};    ///< thickness of the cortical bone below the cartilage
};

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const FemoralHeadShape& shape);

/// A femoral head on its neck, in G: origin at the head's centre, +z up and out of the head; the neck leads
/// down and towards +x. The surface that a tool meets from above is convex.
///
/// Outside: a ball and a rod, joined by a fillet, as a mesh of 1 mm; distances are exact for that mesh.
/// The tissue depends on the depth below the surface, also below the saw cut.
class FemoralHeadSolid final : public Solid {
 public:
  enum Tissue : MaterialIndex { kCartilage = 0, kCortical = 1, kCancellous = 2 };

  /// @throws std::invalid_argument as CheckShape does.
  explicit FemoralHeadSolid(const FemoralHeadShape& shape);

  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override {
    return mesh_.NearestSurface(p_m);
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override { return mesh_.MaterialAt(p_m); }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return mesh_.Bounds(); }

 private:
  MeshSolid mesh_;
};

/// The outer surface.
/// @throws std::invalid_argument as CheckShape does.
[[nodiscard]] TriangleMesh FemoralHeadMesh(const FemoralHeadShape& shape);

}  // namespace osteon::simulation
