#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "simulation/triangle_mesh.h"

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

/// Spatial index over a mesh: boxes in a tree, four a node, and leaves of four triangles.
///
/// The tree is searched in floats, four boxes or triangles at once, and only proposes triangles, with room for
/// its rounding; distances are computed in double. So answers are those of a search through all triangles, to
/// the last bit. (Embree's point query gives the same answers; it calls back for every triangle whose box the
/// search touches, a hundred of them deep inside a bone, and takes up to twice as long.)
class MeshBvh {
 public:
  /// Copies what it needs. @pre the mesh has triangles.
  explicit MeshBvh(const TriangleMesh& mesh);
  ~MeshBvh();
  MeshBvh(const MeshBvh&) = delete;
  MeshBvh& operator=(const MeshBvh&) = delete;

  /// Nearest point of the surface; of equally near triangles, the one that comes first. Any number of
  /// threads.
  [[nodiscard]] TriangleHit Nearest(const Vector3& p_m) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Some edge that passes through a triangle with which it shares no corner: its ends lie more than
/// `tolerance_m` off the triangle's plane on both sides, and the crossing more than that inside its border.
/// Embree (which only the .cpp sees) proposes triangles, double arithmetic decides.
/// @throws std::runtime_error where Embree cannot start.
[[nodiscard]] std::optional<MeshCrossing> FindCrossing(const TriangleMesh& mesh, double tolerance_m);

}  // namespace osteon::simulation
