#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "simulation/mesh/mesh_file.h"
#include "simulation/mesh/triangle_mesh.h"

// The steps by which a file's triangles become a solid: weld vertices, check the mesh, sort the shells.

namespace osteon::simulation {

/// Triangles with shared vertices, and for each triangle the part of the file that it came from.
struct PartedMesh {
  TriangleMesh mesh;
  std::vector<std::string> parts;
  std::vector<std::uint32_t> part_of_triangle;  ///< empty: all triangles belong to one part
};

/// Formats a position in millimetres, for messages.
[[nodiscard]] std::string InMm(const Vector3& p_m);

/// An edge of one triangle, between the vertices `low` and `high`.
struct MeshEdge {
  std::uint32_t low, high, triangle;
  bool rising;  ///< true if the triangle's winding leads from `low` to `high`
  auto operator<=>(const MeshEdge&) const = default;
};
/// The three edges of every triangle, sorted: edges between the same two vertices stand next to each other.
[[nodiscard]] std::vector<MeshEdge> SortedEdges(const TriangleMesh& mesh);

/// Welds vertices of one part that lie at exactly the same place. Drops triangles with two corners in one
/// place, and copies of triangles.
/// @param m_per_unit  metres per unit of the file
[[nodiscard]] PartedMesh WeldParts(const RawMesh& raw, double m_per_unit, MeshReport& report);

/// Welds ends of open edges that are at most `tolerance_m` apart (0: at exactly the same place), also if they
/// belong to different parts.
/// @returns the number of removed vertices.
std::size_t WeldOpenEdges(PartedMesh& parted, double tolerance_m, MeshReport& report);

/// Checks everything that CheckMesh does, and sorts the shells into those that bound the solid and its
/// regions. A mesh without regions keeps its vertices and triangles; the triangles are flipped if the whole
/// mesh was inside out.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> AcceptMesh(PartedMesh parted, const MeshReport& report,
                                                             const std::string& name);

/// Depth above which an edge that passes through a triangle counts as a self-intersection.
inline constexpr double kCrossingTolerance_m = 1e-5;

/// Drops the smallest shells of a closed surface if it has more than SortShells accepts.
/// @returns the number of dropped shells.
std::size_t KeepLargestShells(TriangleMesh& mesh);

/// Finds which shells lie in which, and fills in the report's shells and the regions.
/// @pre `mesh` is manifold, its volume is not negative, and its shells do not cross each other.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> SortShells(PartedMesh parted, MeshReport report,
                                                             const std::string& name);

/// Union-find: disjoint sets of the numbers 0 … count - 1. At first, each number is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  /// Returns the lowest member of the set that contains i.
  [[nodiscard]] std::uint32_t Find(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Joins the sets that contain i and j.
  void Join(std::uint32_t i, std::uint32_t j) {
    i = Find(i);
    j = Find(j);
    parent_[std::max(i, j)] = std::min(i, j);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

}  // namespace osteon::simulation
