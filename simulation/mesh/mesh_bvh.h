#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Nearest feature of a triangle: its face, edge k (from corner k to the next) or corner k.
enum class TriangleFeature : std::uint8_t { kFace, kEdge0, kEdge1, kEdge2, kCorner0, kCorner1, kCorner2 };

/// Nearest point of a mesh to a given point.
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

/// Spatial index over a mesh. A tree of boxes selects the triangles to test for nearest points, and Embree
/// (started by the first search for crossings) selects those that an edge may pierce.
/// All final tests are in double precision, so results do not depend on Embree's version or on an instruction
/// set.
class MeshBvh {
 public:
  /// Copies the parts of the mesh that it needs.
  /// @pre the mesh has triangles.
  explicit MeshBvh(const TriangleMesh& mesh);
  ~MeshBvh();
  MeshBvh(const MeshBvh&) = delete;
  MeshBvh& operator=(const MeshBvh&) = delete;

  /// Nearest point of the surface; of equally near triangles, the first in the mesh counts.
  [[nodiscard]] TriangleHit Nearest(const Vector3& p_m) const;

  /// Finds an edge that passes through a triangle with which it shares no corner. The edge's ends must lie on
  /// both sides of the triangle's plane, each farther than `tolerance_m` from it. The crossing must lie
  /// farther than `tolerance_m` inside the triangle's border.
  /// @throws std::runtime_error if Embree cannot start.
  [[nodiscard]] std::optional<MeshCrossing> FindCrossing(double tolerance_m) const;
  /// Number of edges that pass through a triangle as FindCrossing describes. Each edge counts once, however
  /// many triangles it has.
  /// @throws as FindCrossing.
  [[nodiscard]] std::size_t CountCrossings(double tolerance_m) const;

 private:
  /// The crossing of an edge of a triangle, if it has one.
  [[nodiscard]] std::optional<MeshCrossing> CrossingOf(std::uint32_t triangle,
                                                       const std::array<std::uint32_t, 2>& edge,
                                                       double tolerance_m) const;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace osteon::simulation
