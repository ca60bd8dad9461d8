#pragma once

#include <vector>

#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {

/// Fineness of the cloud of mass points: spacing of about 0.75, 1.5 and 3 mm with depth.
struct MassPointParams {
  /// The mean spacing of the points is the side of their cells, less 7 %.
  GradeParams cells{.finest_m = 0.75e-3, .coarser_from_m = {5e-3, 12e-3}};
  /// Samples along each axis of a cell: candidate places of points, and elements by which volume is
  /// distributed.
  int samples_along_axis{4};
  int threads{0};  ///< 0: one per core. The result does not depend on it.
};

/// Smallest distance of two points, over the mean of their cells' sides.
inline constexpr double kMassPointSeparation = 0.84;

/// Generates blue noise with volumes.
///
/// 1. Points: a Poisson-disk set, drawn over all cells that may hold a part of the solid and then clipped to
///    it. (If they were drawn within the solid, points would crowd along its surface, and the sum over a thin
///    shell would show it.) No two points are nearer than kMassPointSeparation. Where a part of the solid is
///    then farther than 1.5 times that from every point, as in plates and edges thinner than the spacing,
///    points are added.
/// 2. Volumes: each sample of the solid goes to the nearest point of its material within the same slab, a
///    fifth of a cell of depth. Slabs lie below the cut zone in the finest cells close to it, and below the
///    surface elsewhere and where the zone is everywhere. A cut's front moves along such slabs. Volumes add
///    up to the sampled volume of the solid and of each material, and nearly to that of each slab. Without
///    slabs, the first tenths of a millimetre below a surface or a layer's border would be up to 15 % too
///    light or too heavy.
///
/// Sorted along a Morton curve. The result depends on the arguments alone.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<MassPoint> BuildMassPoints(const Solid& solid, const CutZone& zone,
                                                     const MassPointParams& params);

}  // namespace osteon::simulation
