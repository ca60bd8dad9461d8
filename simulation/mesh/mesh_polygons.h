#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "simulation/mesh/mesh_file.h"

// Cuts the polygons of OBJ and PLY files, which share vertices, into triangles; numbers a file's named parts.

namespace osteon::simulation {

/// Polygons of a file, in its own unit. Faces may precede the vertices that they name, so they are cut into
/// triangles after the whole file is read.
struct PolygonMesh {
  struct Polygon {
    std::size_t corners{0};  ///< number of its corners in PolygonMesh::corners
    std::uint32_t part{0};
    std::size_t place{0};  ///< the polygon's line or byte in the file
  };
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::uint32_t> corners;  ///< indices into `vertices`: of the first polygon, then the second …
  std::vector<Polygon> polygons;
};

/// Reason why a polygon was refused.
struct PolygonError {
  std::size_t place{0};  ///< Polygon::place
  std::string what;      ///< what was found and what is accepted
};

/// Cuts polygons into triangles over the same corners, with the same winding, and adds them to `raw`.
///
/// Corners that repeat the one before are left out; a polygon with fewer than three left becomes one triangle
/// without area. A fan from the first corner is used where all its triangles have the polygon's winding.
/// Elsewhere ears are cut (Meisters, Polygons have ears, Am. Math. Monthly 82, 1975), in the plane of the
/// polygon's mean normal.
/// @pre every corner's index is below mesh.vertices.size().
/// @returns the first polygon that is refused: it visits a vertex twice, crosses itself, or is concave with
///   more than 1024 corners.
[[nodiscard]] std::optional<PolygonError> TriangulatePolygons(const PolygonMesh& mesh, RawMesh& raw);

/// Numbers the parts of a file; parts of one name are one part.
class PartNames {
 public:
  /// Number of the part of this name. A name that is not UTF-8 is read as Latin-1.
  [[nodiscard]] std::uint32_t NumberOf(std::string_view name);
  /// Moves the names out, in the order of their numbers.
  [[nodiscard]] std::vector<std::string> Take() { return std::move(names_); }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace osteon::simulation
