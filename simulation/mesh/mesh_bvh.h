#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// What of a triangle lies nearest: its face, edge k (from corner k to the next) or corner k.
enum class TriangleFeature : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kCorner0, kCorner1, kCorner2 };

struct TriangleHit {
  Vector3 p_m{Vector3::Zero()};
  double distance_m{0.0};
  std::uint32_t triangle{0};
  TriangleFeature feature{TriangleFeature::kFace};
};

/// An edge that pierces a triangle.
struct MeshCrossing {
  Vector3 p_m{Vector3::Zero()};
  std::uint32_t edge_triangle{0};
  std::uint32_t triangle{0};
};

/// Spatial index over a mesh (Embree, which only the .cpp sees). Distances are computed in double; Embree
/// only chooses which triangles to look at, with room for its rounding, so answers do not depend on its
/// version or instruction set.
class MeshBvh {
 public:
  /// Copies what it needs. @throws std::runtime_error where Embree cannot start. @pre the mesh has triangles.
  explicit MeshBvh(const TriangleMesh& mesh);
  ~MeshBvh();
  MeshBvh(const MeshBvh&) = delete;
  MeshBvh& operator=(const MeshBvh&) = delete;

  /// Nearest point of the surface; of equally near triangles, the one that comes first.
  [[nodiscard]] TriangleHit Nearest(const Vector3& p_m) const;

  /// Some edge that passes through a triangle with which it shares no corner: its ends lie more than
  /// `tolerance_m` off the triangle's plane on both sides, and the crossing more than that inside its border.
  [[nodiscard]] std::optional<MeshCrossing> FindCrossing(double tolerance_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::simulation
