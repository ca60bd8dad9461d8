#pragma once

#include <functional>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Level function of a shape: its value at p is negative inside and positive outside. It is continuous, in
/// any unit.
using LevelFunction = std::function<double(const Vector3& p_m)>;

/// Meshes the surface where `level` is zero: marching tetrahedra on a cubic grid, six tetrahedra a cube.
///
/// The mesh is closed, manifold and free of self-intersection by construction: neighbouring cubes cut their
/// common face along the same diagonal, each edge of the grid carries at most one vertex, and each triangle
/// stays within its tetrahedron. The vertices lie on the surface (bisection along the edges, by default to
/// 1e-6 of the step), except near the grid's own vertices: from these they are moved away by up to a
/// twentieth of the step to avoid needle-like triangles. Features thinner than the step may be lost.
/// @param box  must hold the surface with one step to spare
/// @param step_m  edge of the grid's cubes
/// @param rounds  number of bisections; each one halves the error of the vertices
/// @throws std::invalid_argument if the shape reaches the box's border or is empty, or the grid would have
///   more than 50 million vertices.
[[nodiscard]] TriangleMesh MeshOfLevel(const LevelFunction& level, const Eigen::AlignedBox3d& box,
                                       double step_m, int rounds = 20);

/// A ring of points. All rings of a mesh have the same number of points.
using Ring = std::vector<Vector3>;

/// Makes the tube through a row of rings, closed by fans over the first and the last ring. Seen from the end
/// of the row, each ring runs counter-clockwise (seen from +z for rings in ascending z).
/// @throws std::invalid_argument unless there are at least two rings, all of the same number of points, at
///   least three.
[[nodiscard]] TriangleMesh MeshOfRings(const std::vector<Ring>& rings);

}  // namespace osteon::simulation
