#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "base/file_error.h"
#include "simulation/mesh/triangle_mesh.h"
#include "simulation/surface/loose_pieces.h"
#include "simulation/surface/welded_surface.h"

namespace osteon::surface {

/// Figures of a written surface.
struct SurfaceFigures {
  std::size_t triangles{0};
  double volume_mm3{0.0};
  bool watertight{false};  ///< every edge has two triangles, of the same winding
  PieceFigures pieces{};
};

/// Makes two triangles of each quad, cut along its shorter diagonal. Converts millimetres to metres.
[[nodiscard]] simulation::TriangleMesh ToTriangles(const WeldedSurface& mesh);

/// Writes the carved bone, in millimetres and in G: binary STL, binary PLY or OBJ, by the file's extension.
/// The file appears whole or not at all. Where the sharp rims make the surface fold (CheckMesh), it is made
/// without them.
/// @param drop_below_mm3  as DropPiecesBelow
[[nodiscard]] tl::expected<SurfaceFigures, simulation::FileError> WriteSurface(
    const std::filesystem::path& path, const CarvedField& field, double drop_below_mm3 = 0.0);

/// Says why a file's name is refused; empty if it is accepted.
[[nodiscard]] std::string ValidateSurfaceName(const std::filesystem::path& path);

}  // namespace osteon::surface
