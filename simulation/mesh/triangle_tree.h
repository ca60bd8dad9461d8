#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulation/mesh/mesh_bvh.h"

namespace osteon::simulation {

/// Tree of boxes over a mesh's triangles, for nearest points. A node has four children side by side, a leaf
/// four triangles, so that one pass of SIMD measures all four. Boxes and discs are in floats. They only
/// select the triangles to test, with a margin for rounding. Distances are computed in double precision, so
/// the result has the same bits as a test of all triangles.
class TriangleTree {
 public:
  /// Copies the parts of the mesh that it needs.
  /// @pre the mesh has triangles.
  explicit TriangleTree(const TriangleMesh& mesh);

  /// Nearest point of the surface. Of equally near triangles, the first in the mesh counts. Each thread
  /// remembers its last search, so a query for the same point costs nothing, and a query for a point near it
  /// little.
  [[nodiscard]] TriangleHit Nearest(const Vector3& p_m) const;

 private:
  struct Triangle {
    std::array<Vector3, 3> corners_m;
    std::uint32_t index;  ///< index in the mesh
  };
  using Four = std::array<float, 4>;
  struct alignas(16) Node {
    /// Corners of the children's boxes, [axis][child], relative to middle_m_ [m]
    std::array<Four, 3> low, high;
    std::array<std::int32_t, 4> child;  ///< index of a node; ~i: leaf i; or kNoChild
  };
  /// Up to four triangles, each within a disc, which bounds an oblique triangle more tightly than a box.
  struct alignas(16) Leaf {
    std::array<Four, 3> center{};      ///< [axis][triangle], relative to middle_m_ [m]
    std::array<Four, 3> normal{};      ///< unit normal; 0 for a needle, which gets a ball instead of a disc
    Four radius{};                     ///< [m]
    std::uint32_t first{0}, count{0};  ///< range in triangles_
  };
  struct Search;

  /// Makes the node of triangles_[first, end), and the nodes and leaves below it. @returns the node's index.
  std::int32_t Divide(std::uint32_t first, std::uint32_t end);
  /// Makes the leaf of triangles_[first, end). @returns the leaf's index.
  std::int32_t MakeLeaf(std::uint32_t first, std::uint32_t end);
  /// Sorts triangles_[first, end) into two halves. @returns where the second one begins.
  std::uint32_t Halve(std::uint32_t first, std::uint32_t end);

  Vector3 middle_m_{Vector3::Zero()};
  double extent_m_{0.0};  ///< largest coordinate of a vertex relative to middle_m_
  /// Number that no other tree of this process has, not even a later tree at the same address
  std::uint64_t id_;
  std::vector<Triangle> triangles_;
  std::vector<Node> nodes_;  ///< the root is the first
  std::vector<Leaf> leaves_;
};

}  // namespace osteon::simulation
