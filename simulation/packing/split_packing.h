#pragma once

#include <cstdint>
#include <vector>

#include "simulation/packing/packing_builder.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Parameters of a packing of few, large balls, each of which is split when a tool touches it (SplitParams).
/// It is meant for tools whose radius is not much larger than that of the balls.
struct SplitPackingParams {
  double spacing_m{2.5e-3};  ///< spacing of the body-centred lattice in the cut zone
  /// Radius of its balls over the spacing; from 0.56 on, the lattice has no holes
  double radius_over_spacing{0.9};
  /// Depth below the zone down to which the packing is as fine as in it. A zone that is a surface (a cup, a
  /// face) needs the depth that will be cut below it; a zone that holds the whole cut (a path) needs none.
  double fine_depth_m{0.0};
  double coarser_from_m{1.5e-3};    ///< depth below the fine part at which the spacing doubles; it doubles
                                    ///< again at twice this depth
  double surface_radius_m{1.2e-3};  ///< largest radius of the balls that touch the surface in the zone
  double surface_gap_m{0.2e-3};     ///< largest gap between the surface and the balls, in the zone
  std::uint64_t seed{0};            ///< moves the surface samples
  int threads{0};                   ///< 0: one per core; the result does not depend on it
};

/// Builds a graded body-centred lattice of balls, and balls that touch the surface from inside. The balls at
/// the surface are small, because their children have to fill the rim of a cut. Below the zone, both kinds of
/// balls grow with the depth.
///
/// Sorted along a Morton curve. The result depends on the arguments alone.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildSplitPacking(const Solid& solid, const CutZone& zone,
                                                  const SplitPackingParams& params);

/// Parameters of a split packing that can replace a packing of unsplit balls. Its spacing is 5/3 times as
/// wide; its fine part is equally deep below the zone, and its gap at the surface is the same. Where a burr
/// cuts, it has a fourth or fifth of the balls, and its cuts are at least as exact.
[[nodiscard]] SplitPackingParams SplitPackingFor(const PackingParams& packing);

}  // namespace osteon::simulation
