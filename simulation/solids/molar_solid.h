#pragma once

#include "simulation/solids/mesh_solid.h"

namespace osteon::simulation {

/// Sizes of the generated molar. The proportions are those of a human lower first molar, from memory: four
/// cusps around a cross of fissures, a narrower neck, two roots that bend backwards, and a pulp whose chamber
/// has a horn under each cusp and sends two canals into the front root and one into the back root.
struct MolarShape {
  /// Length from the highest cusp to the roots' tips; all sizes except the enamel's scale with this length.
  double length_m{0.0206};
  double enamel_m{0.0020};  ///< thickness of the enamel at the top; it decreases to 0 at the neck
  double pulp_width{1.0};   ///< width factor of the pulp's chamber, horns and canals; they narrow with age
};

/// @throws std::invalid_argument naming the size, its value and what is accepted.
void CheckShape(const MolarShape& shape);

/// A molar in G: origin in the middle of the neck (where the enamel ends), +z towards the occlusal surface,
/// +x from the back root to the front root, y along the cheek-tongue direction.
///
/// Distances are exact for a mesh of the outer surface (shape_mesh.h). The pulp is a nested region of the
/// mesh. The enamel is a layer below the crown's surface. Its thickness is e u (2 - u), e being enamel_m and
/// u = z / (60 % of the crown's height), clamped to 0 … 1. z is the height of the nearest surface point.
class MolarSolid final : public Solid {
 public:
  enum Tissue : MaterialIndex { kEnamel = 0, kDentine = 1, kPulp = 2 };

  /// @throws std::invalid_argument as CheckShape does.
  explicit MolarSolid(const MolarShape& shape);

  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override {
    return mesh_.NearestSurface(p_m);
  }
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  [[nodiscard]] std::optional<SurfacePoint> RegionDistance(MaterialIndex material,
                                                           const Vector3& p_m) const override {
    return mesh_.RegionDistance(material, p_m);
  }
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return mesh_.Bounds(); }

  /// Thickness of the enamel where the surface has this height z.
  [[nodiscard]] double EnamelThickness(double z_m) const;

 private:
  MolarShape shape_;
  MeshSolid mesh_;
};

/// The molar's outer surface with its pulp as a region. MolarSolid measures distances to this mesh, and it
/// can be saved as a mesh file.
/// @throws std::invalid_argument as CheckShape does.
[[nodiscard]] LoadedMesh MolarMesh(const MolarShape& shape);

}  // namespace osteon::simulation
