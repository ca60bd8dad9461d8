#pragma once

#include <functional>
#include <vector>

#include "simulation/mesh/triangle_mesh.h"

namespace osteon::simulation {

/// Value of a shape at p [any unit]: negative inside, continuous.
using LevelFunction = std::function<double(const Vector3& p_m)>;

/// The surface where `level` is zero, as a mesh: marching tetrahedra on a cubic grid, six tetrahedra a cube.
///
/// Closed, manifold and free of self-intersection by construction: neighbouring cubes cut their common face
/// along the same diagonal, each edge of the grid carries at most one vertex, and each triangle stays within
/// its tetrahedron. The vertices lie on the surface (bisection along the edges, to 1e-6 of the step), but for
/// those pulled away from the grid's own vertices by up to a twentieth of the step, lest triangles become
/// needles. Features thinner than the step may be lost.
/// @param box  must hold the surface with one step to spare; @param step_m  edge of the grid's cubes
/// @throws std::invalid_argument where the shape reaches the box's border, is empty, or the grid would have
/// more than 50 million vertices.
[[nodiscard]] TriangleMesh MeshOfLevel(const LevelFunction& level, const Eigen::AlignedBox3d& box,
                                       double step_m);

/// A ring of points, all rings of one mesh of the same count.
using Ring = std::vector<Vector3>;

/// The tube through a row of rings, each counter-clockwise seen from where the row leads (+z for rings in
/// ascending z), closed by fans over the first and the last one.
/// @throws std::invalid_argument unless there are two rings and more, of the same three points and more.
[[nodiscard]] TriangleMesh MeshOfRings(const std::vector<Ring>& rings);

}  // namespace osteon::simulation
