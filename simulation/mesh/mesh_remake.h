#pragma once

#include <string>

#include "simulation/mesh/mesh_steps.h"

namespace osteon::simulation {

/// Makes a closed surface from triangles that do not bound a solid. The mesh may be open, have edges with
/// three or more triangles, have neighbours of opposite winding, pass through itself, or have too many
/// shells.
///
/// 1. Each shell (triangles joined by edges with exactly two triangles) is wound in one sense, then outwards.
///    A shell that is wound inwards and lies within other shells stays a cavity.
/// 2. The solid is where the winding number is above one half (winding_number.h). This closes holes with a
///    smooth surface over their rims, merges solids that overlap, and drops walls within a solid.
/// 3. That surface is meshed on a cubic grid (MeshOfLevel) of at most `grid_points` points. Its vertices
///    lie on the file's triangles, up to a twentieth of the grid's step; thinner features are lost. If there
///    are more than 64 shells, the smallest are dropped.
///
/// Shells of another tissue within a solid are not recognised, so the result has no regions.
/// @returns the mesh, with the defects and repairs in report.remake. Or an error: the triangles form no solid
///   if, of the volume with a winding number above 0.5, less than half has one above 0.8, as around a sheet
///   or a bowl.
[[nodiscard]] tl::expected<LoadedMesh, std::string> RemakeMesh(const PartedMesh& parted,
                                                               const MeshReport& report, double grid_points);

}  // namespace osteon::simulation
