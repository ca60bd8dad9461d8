#pragma once

#include <vector>

#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {

/// Fineness of the mass points. By default, their spacing is about 0.75, 1.5 and 3 mm with increasing depth.
struct MassPointParams {
  /// Cells in which points are drawn. The mean spacing of the points is 7 % less than the side of their
  /// cells.
  GradeParams cells{.finest_m = 0.75e-3, .coarser_from_m = {5e-3, 12e-3}};
  /// Samples along each axis of a cell. A sample is a candidate for a point, and an element of volume that is
  /// assigned to a point.
  int samples_along_axis{4};
  int threads{0};  ///< 0: one per core. The result does not depend on it.
};

/// One separation: smallest distance of two points, divided by the mean of the sides of their cells.
inline constexpr double kMassPointSeparation = 0.84;

/// Generates mass points: blue noise in the solid, and a volume for each point.
///
/// 1. Points: a Poisson-disk set, drawn over all cells that may hold a part of the solid and then clipped to
///    it. (If they were drawn within the solid, points would crowd along its surface, and the sum over a thin
///    shell would show it.) No two points are nearer than one separation. Points are added where a part of
///    the solid is then farther than 1.5 separations from every point, as in thin plates and edges.
/// 2. Volumes: the volume of each sample is added to the nearest point of its material within the same slab.
///    A slab is a layer of depths, a fifth of a cell thick. The depth is counted from the cut zone in the
///    finest cells close to the zone, and from the surface elsewhere (everywhere if the zone is everywhere).
///    A cut advances through such slabs one after the other. The points' volumes add up to the sampled volume
///    of the solid and of each material, and nearly to that of each slab. Without slabs, the first tenths of
///    a millimetre below a surface or a layer's border would be up to 15 % too light or too heavy.
///
/// Sorted along a Morton curve. The result depends on the arguments alone.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<MassPoint> BuildMassPoints(const Solid& solid, const CutZone& zone,
                                                     const MassPointParams& params);

}  // namespace osteon::simulation
