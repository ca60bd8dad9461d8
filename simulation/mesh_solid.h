#pragma once

#include <memory>

#include "simulation/mesh_bvh.h"
#include "simulation/solid.h"

namespace osteon::simulation {

/// Tissue of a bone that comes as a mesh: thicknesses below its surface.
struct MeshTissue {
  double cartilage_m{0.002};    ///< inside the cup
  double subchondral_m{0.001};  ///< cortical plate below the cartilage
  double cortical_m{0.0015};    ///< shell everywhere else; cancellous below
  /// The cup's lining is where the surface lies within this many cup radii of the cup's centre, not above the
  /// opening, and faces the centre.
  double lining_radii{1.25};
};

/// The solid that a closed mesh bounds.
class MeshSolid final : public Solid {
 public:
  /// @pre CheckMesh accepts the mesh.
  MeshSolid(const TriangleMesh& mesh, const Cup& cup, const MeshTissue& tissue);

  /// Sign by the angle-weighted pseudonormal of the nearest face, edge or vertex, which is right for every
  /// closed manifold. Source: Baerentzen, Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return box_; }
  [[nodiscard]] const Cup& cup() const { return cup_; }

 private:
  struct Triangle {
    Vector3 face_normal;
    std::array<Vector3, 3> edge_normals, corner_normals;  ///< not of unit length
  };
  [[nodiscard]] const Vector3& NormalAt(const TriangleHit& hit) const;
  [[nodiscard]] double Signed(const Vector3& p_m, const TriangleHit& hit) const;

  Cup cup_;
  MeshBvh bvh_;
  MeshTissue tissue_;
  Eigen::AlignedBox3d box_;
  std::vector<Triangle> triangles_;
};

}  // namespace osteon::simulation
