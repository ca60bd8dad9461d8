#pragma once

#include <vector>

#include "simulation/graded_cells.h"

namespace osteon::simulation {

/// How fine the cloud of mass points is: cells of .75, 1.5 and 3 mm, one point in each.
struct MassPointParams {
  GradeParams cells{.finest_m = 0.75e-3, .coarser_from_m = {5e-3, 12e-3}};
  /// Cells that the surface passes through are sampled this often along each axis, to find how much of them
  /// is bone.
  int samples_along_axis{4};
};

/// One point for each cell of a graded division, at a quasi-random place in it, with the volume of its bone.
///
/// Where the surface crosses a cell, volume and place come from stratified random samples: both are unbiased,
/// so the errors of many cells cancel in a sum, over the solid as over any region cut from it. Sorted along a
/// Morton curve. The result depends on the arguments alone.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<MassPoint> BuildMassPoints(const Solid& solid, const CutZone& zone,
                                                     const MassPointParams& params);

}  // namespace osteon::simulation
