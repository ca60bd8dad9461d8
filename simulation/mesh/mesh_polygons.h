#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "simulation/mesh/mesh_file.h"

// Cuts the polygons of OBJ and PLY files into triangles, and numbers a file's named parts.

namespace osteon::simulation {

/// The polygons of a file, in the file's unit. A face may stand before its vertices in the file, so polygons
/// are cut into triangles after the whole file is read.
struct PolygonMesh {
  struct Polygon {
    std::size_t corners{0};  ///< number of the polygon's corners in PolygonMesh::corners
    std::uint32_t part{0};
    std::size_t place{0};  ///< the polygon's line or byte in the file
  };
  std::vector<std::array<float, 3>> vertices;
  /// Indices into `vertices`: the first polygon's corners, then the second one's, …
  std::vector<std::uint32_t> corners;
  std::vector<Polygon> polygons;
};

/// Reason why a polygon was refused.
struct PolygonError {
  std::size_t place{0};  ///< Polygon::place
  std::string what;      ///< what was found and what is accepted
};

/// Cuts polygons into triangles and adds these to `raw`. The triangles have the polygon's corners and
/// winding.
///
/// A corner that repeats the corner before it is left out. If fewer than three corners are left, the polygon
/// becomes one triangle without area. The polygon becomes a fan from its first corner if all triangles of
/// this fan have the polygon's winding. Otherwise ears are cut off (Meisters, Polygons have ears, Am. Math.
/// Monthly 82, 1975), in the plane of the polygon's mean normal.
/// @pre every corner's index is below mesh.vertices.size().
/// @returns the first polygon that is refused, if any: it visits a vertex twice, crosses itself, or is
///   concave with more than 1024 corners.
[[nodiscard]] std::optional<PolygonError> TriangulatePolygons(const PolygonMesh& mesh, RawMesh& raw);

/// Numbers the parts of a file by their names. Parts with the same name get the same number.
class PartNames {
 public:
  /// Number of the part with this name. A name that is not valid UTF-8 is read as Latin-1.
  [[nodiscard]] std::uint32_t NumberOf(std::string_view name);
  /// Moves the names out, in the order of their numbers.
  [[nodiscard]] std::vector<std::string> Take() { return std::move(names_); }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace osteon::simulation
