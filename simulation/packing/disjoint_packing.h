#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Number and radii of a disjoint packing's balls.
struct DisjointParams {
  std::size_t count{10'000};  ///< 0: until no ball of the least radius fits any more
  double min_radius_m{
      0.02e-3};              ///< smaller holes stay empty, even if there are fewer balls than `count` then
  double max_radius_m{1.0};  ///< at the cut zone and above it
  double grade{
      0.0};  ///< the largest radius grows by this times the depth of the centre below the zone; 0: nowhere
  std::uint64_t seed{0};  ///< selects one of many equally good packings
  int threads{0};         ///< 0: one a core; the result does not depend on it
};

/// Fills a solid with disjoint balls, the largest that fits first. This is the cutting paper's packing: it
/// represents the shape well but loses more to a cut than overlapping balls (packing_builder.h).
///
/// 1. Prototypes climb from the solid's thick places to local maxima of the clearance: the distance to the
///    surface or to the nearest ball (clearance_climb.h). The maxima wait as holes, sorted by radius.
/// 2. Among the holes whose radii lie within 5 % of the largest, those still free are filled, larger before
///    smaller. Prototypes climb beside each new ball (hole_search.h), and from holes that it cuts. This
///    repeats until there are enough balls or no holes.
/// 3. Without holes, space is searched for missed holes. A packing that ends for lack of room therefore has
///    no place for a ball of 1.02 times the least radius.
///
/// Greedy except within these 5 %. Climbs run in parallel while no ball is added; filling is serial and
/// short. The result therefore depends on the arguments alone. It is sorted along a Morton curve. A million
/// balls take about 0.3 GB.
///
/// Source of the idea: Weller, Zachmann, "ProtoSphere: A GPU-Assisted Prototype Guided Sphere Packing
/// Algorithm for Arbitrary Objects", SIGGRAPH Asia Sketches, 2010.
/// @returns `count` balls, or fewer where no more fit. None reaches out of the solid or into another one
///   (both by more than rounding).
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildDisjointPacking(const Solid& solid, const CutZone& zone,
                                                     const DisjointParams& params);

}  // namespace osteon::simulation
