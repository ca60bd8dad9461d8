#pragma once

#include <string>

#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {

/// Makes a closed surface of triangles that bound no solid as they are: open, with edges of three triangles
/// or more, wound in contrary senses, passing through themselves, or of too many shells.
///
/// 1. Each shell (triangles joined by edges of exactly two) is wound in one sense, then outwards. A shell
///    that is wound inwards within others stays a cavity.
/// 2. The solid is where the winding number is above one half (winding_number.h). This closes holes with a
///    smooth surface over their rims, merges solids that overlap, and drops walls within a solid.
/// 3. That surface is meshed on a cubic grid (MeshOfLevel) of at most `grid_points` points. Its vertices
///    lie on the file's triangles, up to a twentieth of the grid's step; thinner features are lost. Beyond
///    64 shells the smallest are dropped.
///
/// Shells of other tissue within a solid are not told apart: there are no regions.
/// @returns the mesh, with the defects and repairs in report.remake; or why the triangles bound no solid,
///   where less than half of the volume above one half is above 0.8, as around a sheet or a bowl.
[[nodiscard]] tl::expected<LoadedMesh, std::string> RemakeMesh(const PartedMesh& parted,
                                                               const MeshReport& report, double grid_points);

}  // namespace osteon::simulation
