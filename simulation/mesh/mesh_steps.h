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

// The steps from a file's triangles to a solid: weld, check, sort the shells.

namespace osteon::simulation {

/// Triangles over shared vertices, and the part of the file that each came from.
struct PartedMesh {
  TriangleMesh mesh;
  std::vector<std::string> parts;
  std::vector<std::uint32_t> part_of_triangle;  ///< empty: all triangles belong to one part
};

/// Formats a place for messages.
[[nodiscard]] std::string InMm(const Vector3& p_m);

/// An edge as one of its triangles has it.
struct MeshEdge {
  std::uint32_t low, high, triangle;
  bool rising;  ///< true where the triangle runs from low to high
  auto operator<=>(const MeshEdge&) const = default;
};
/// The three edges of every triangle; those between the same two vertices are adjacent.
[[nodiscard]] std::vector<MeshEdge> SortedEdges(const TriangleMesh& mesh);

/// Welds vertices at exactly the same place, each part on its own, and drops triangles that collapse or occur
/// twice.
/// @param m_per_unit  metres to a unit of the file
[[nodiscard]] PartedMesh WeldParts(const RawMesh& raw, double m_per_unit, MeshReport& report);

/// Welds ends of open edges within the tolerance of each other (0: at exactly the same place), also across
/// parts.
/// @returns the number of removed vertices.
std::size_t WeldOpenEdges(PartedMesh& parted, double tolerance_m, MeshReport& report);

/// Checks everything that CheckMesh does, and sorts the shells into those that bound the solid and its
/// regions. A mesh without regions keeps its vertices and triangles as they are (or all flipped).
[[nodiscard]] tl::expected<LoadedMesh, MeshError> AcceptMesh(PartedMesh parted, const MeshReport& report,
                                                             const std::string& name);

/// An edge that passes deeper through a triangle is a self-intersection.
inline constexpr double kCrossingTolerance_m = 1e-5;

/// Drops the smallest shells of a closed surface beyond the number that SortShells accepts.
/// @returns the number of dropped shells.
std::size_t KeepLargestShells(TriangleMesh& mesh);

/// Finds how the shells nest; fills the report's shells and the regions.
/// @pre `mesh` is manifold, its volume is not negative, and its shells do not cross each other.
[[nodiscard]] tl::expected<LoadedMesh, MeshError> SortShells(PartedMesh parted, MeshReport report,
                                                             const std::string& name);

/// Union-find: disjoint sets of the numbers below `count`, at first each by itself.
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
