#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// How many balls a disjoint packing gets, and how large they may be.
struct DisjointParams {
  std::size_t count{10'000};  ///< 0: until no ball of the least radius fits any more
  double least_radius_m{
      0.02e-3};  ///< smaller holes stay empty, even where that makes fewer balls than `count`
  double greatest_radius_m{1.0};  ///< down to the cut zone's surface
  double grade{
      0.0};  ///< the greatest radius grows by this times the centre's depth below the zone; 0: nowhere
  std::uint64_t seed{0};  ///< another one, another packing that is as good
  int threads{0};         ///< 0: one a core; the result does not depend on it
};

/// Fills a solid with disjoint balls, the largest that fits first: the packing that the cutting paper uses,
/// for shape at the cost of cuts (overlapping ones, packing_builder.h, lose less to a cut).
///
/// 1. Prototypes climb from the solid's thick places to local maxima of the clearance, the distance to the
/// surface or
///    to the nearest ball (clearance_climb.h). Those wait, as holes, by their radius.
/// 2. Of the holes whose radii lie within 5 % of the largest one's, those that are still free are filled, the
/// larger
///    before the smaller; prototypes climb beside each new ball (hole_search.h), and from holes that it has
///    cut. Again, until there are enough balls or no holes.
/// 3. Without holes, space is searched for one that was missed: when it ends for lack of room, no ball
/// of 1.02 times
///    the least radius fits anywhere.
///
/// Greedy but for these 5 %. Climbs run in parallel against balls that rest, filling is serial and short: so
/// the result depends on the arguments alone. It is sorted along a Morton curve. A million balls take about
/// 0.3 GB.
///
/// Source of the idea: Weller, Zachmann, "ProtoSphere: A GPU-Assisted Prototype Guided Sphere Packing
/// Algorithm for Arbitrary Objects", SIGGRAPH Asia Sketches, 2010.
/// @returns `count` balls, or fewer where no more fit. None reaches out of the solid or into another one
/// (both
///   by more than rounding).
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildDisjointPacking(const Solid& solid, const CutZone& zone,
                                                     const DisjointParams& params);

}  // namespace osteon::simulation
