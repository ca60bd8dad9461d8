#pragma once

#include <array>
#include <memory>
#include <vector>

#include "simulation/mesh/mesh_bvh.h"
#include "simulation/solids/solid.h"
#include "simulation/solids/tissue_map.h"

namespace osteon::simulation {

/// Signed distances to a closed surface: negative inside.
///
/// The sign follows from the angle-weighted pseudonormal of the nearest face, edge or vertex. It is correct
/// for every closed manifold. Source: Baerentzen, Aanaes, IEEE Trans. Vis. Comput. Graph. 11, 2005.
class MeshDistance {
 public:
  /// @pre CheckMesh accepts the mesh.
  explicit MeshDistance(const TriangleMesh& mesh);

  struct Point {
    TriangleHit hit;
    Vector3 normal{Vector3::Zero()};  ///< outward at the nearest point, not of unit length
    double distance_m{0.0};           ///< signed
  };
  /// The surface's point nearest to p.
  [[nodiscard]] Point Nearest(const Vector3& p_m) const;
  [[nodiscard]] const Eigen::AlignedBox3d& bounds() const { return box_; }

 private:
  MeshBvh bvh_;
  Eigen::AlignedBox3d box_;
  // Separate arrays, because nearly every search ends on a face and should load only the faces' normals. Only
  // the faces' normals have unit length.
  std::vector<Vector3> face_normals_;                   ///< one for each triangle
  std::vector<Vector3> edge_normals_, corner_normals_;  ///< three for each triangle
};

/// The solid that a closed mesh bounds, with the regions of other tissue in it.
class MeshSolid final : public Solid {
 public:
  /// @pre CheckMesh accepts the mesh; `tissue` passes CheckTissueMap.
  MeshSolid(const LoadedMesh& loaded, TissueMap tissue);
  /// Makes the solid of a mesh without regions.
  explicit MeshSolid(const TriangleMesh& mesh, TissueMap tissue = {});

  /// Distance to the solid's boundary: its outer surface and its cavities. Regions bound nothing.
  [[nodiscard]] SurfacePoint NearestSurface(const Vector3& p_m) const override;
  /// The tissue at p. It depends on the depth below the surface of the innermost region around p; outside all
  /// regions, on the depth below the solid's surface. Cost: at most one search for each region whose box
  /// contains p, and one more search unless the tissue there is the same at every depth.
  [[nodiscard]] MaterialIndex MaterialAt(const Vector3& p_m) const override;
  /// Nearest point on the surfaces of the regions that consist of this material. Nothing unless the material
  /// fills whole regions and occurs nowhere else.
  [[nodiscard]] std::optional<SurfacePoint> RegionDistance(MaterialIndex material,
                                                           const Vector3& p_m) const override;
  [[nodiscard]] Eigen::AlignedBox3d Bounds() const override { return boundary_.bounds(); }
  [[nodiscard]] const TissueMap& tissue() const { return tissue_; }

 private:
  /// Tissue of a shell: 0 is the whole solid, i + 1 is region i.
  [[nodiscard]] const ShellTissue& Tissue(std::size_t shell) const;

  MeshDistance boundary_;
  std::vector<std::unique_ptr<MeshDistance>> regions_;  ///< a region comes before the regions inside it
  TissueMap tissue_;
};

}  // namespace osteon::simulation
