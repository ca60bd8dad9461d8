#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "simulation/mesh/mesh_file.h"

// Polygons over shared vertices, as OBJ and PLY have them, cut into triangles; names of a file's parts.

namespace osteon::simulation {

/// Polygons of a file, in its own unit. Faces may stand before the vertices that they name, so they are cut
/// into triangles when all is read.
struct PolygonMesh {
  struct Polygon {
    std::size_t corners{0};  ///< how many of `corners` are its own
    std::uint32_t part{0};
    std::size_t place{0};  ///< the line or byte where it stands
  };
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::uint32_t> corners;  ///< places in `vertices`: of the first polygon, then of the second …
  std::vector<Polygon> polygons;
};

/// Why a polygon has no triangles.
struct PolygonError {
  std::size_t place{0};  ///< Polygon::place
  std::string what;      ///< what was found and what is accepted
};

/// Cuts polygons into triangles over the same corners, wound alike, and adds them to `raw`.
///
/// Corners that repeat the one before are left out; a polygon with fewer than three left becomes one
/// triangle without area. Where a fan from the first corner has only triangles of the polygon's own sense,
/// it is taken; elsewhere ears are cut (Meisters, Polygons have ears, Am. Math. Monthly 82, 1975), in the
/// plane of the polygon's mean normal. Corners of index < mesh.vertices.size() are a precondition.
/// @returns the first polygon that is refused: it visits a vertex twice, crosses itself, or is concave with
///   more than 1024 corners.
[[nodiscard]] std::optional<PolygonError> CutPolygons(const PolygonMesh& mesh, RawMesh& raw);

/// Numbers the parts that triangles are of; one name is one part.
class PartNames {
 public:
  /// The number of the part of this name, which need not be UTF-8: what is not is read as Latin-1.
  [[nodiscard]] std::uint32_t NumberOf(std::string_view name);
  [[nodiscard]] std::vector<std::string> Take() { return std::move(names_); }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace osteon::simulation
