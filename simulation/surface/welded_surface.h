#pragma once

#include <array>
#include <vector>

#include "simulation/surface/dual_surface.h"

namespace osteon::surface {

/// One closed mesh of all chunks.
struct WeldedSurface {
  std::vector<Vec3> vertices_mm;
  std::vector<std::array<std::uint32_t, 4>> quads;  ///< counter-clockwise seen from outside
};

/// Extracts every brick and joins vertices of the same cell and patch.
[[nodiscard]] WeldedSurface WeldSurface(const CarvedField& field, const ExtractOptions& options = {});

/// Counts of half edges that are not shared by exactly two quads. Both 0: the mesh is watertight and
/// manifold.
struct EdgeCounts {
  std::size_t open{0};         ///< half edges without an opposite one
  std::size_t over_shared{0};  ///< half edges that occur more than once
};
[[nodiscard]] EdgeCounts CountEdges(const WeldedSurface& mesh);

/// Removes vertices that no quad uses.
void RemoveUnusedVertices(WeldedSurface& mesh);

/// Signed volume [mm³] between a quad and the origin. The sum over all quads of a closed mesh is the enclosed
/// volume.
[[nodiscard]] double VolumeUnder(const WeldedSurface& mesh, const std::array<std::uint32_t, 4>& quad);

/// Enclosed volume [mm³], by the divergence theorem, each quad as two triangles.
[[nodiscard]] double VolumeOf(const WeldedSurface& mesh);

}  // namespace osteon::surface
