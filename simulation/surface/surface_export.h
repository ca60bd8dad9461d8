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
  bool watertight{false};  ///< every edge has two triangles, which have the same winding
  PieceFigures pieces{};
};

/// Converts a mesh: each quad is cut into two triangles along its shorter diagonal. Converts millimetres to
/// metres.
[[nodiscard]] simulation::TriangleMesh ToTriangles(const WeldedSurface& mesh);

/// Writes the carved bone, in millimetres and in G: binary STL, binary PLY or OBJ, by the file's extension.
/// The file appears complete or not at all. If sharp rims make the surface pass through itself (CheckMesh
/// refuses it), the surface is made without sharp rims.
/// @param drop_below_mm3  as DropPiecesBelow
[[nodiscard]] tl::expected<SurfaceFigures, simulation::FileError> WriteSurface(
    const std::filesystem::path& path, const CarvedField& field, double drop_below_mm3 = 0.0);

/// Says why a file's name is refused; empty if it is accepted.
[[nodiscard]] std::string ValidateSurfaceName(const std::filesystem::path& path);

}  // namespace osteon::surface
