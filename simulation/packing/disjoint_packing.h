#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"

namespace osteon::simulation {

/// Number and radii of a disjoint packing's balls.
struct DisjointParams {
  std::size_t count{10'000};  ///< number of balls; 0: as many as fit with at least min_radius_m
  /// Holes smaller than this stay empty, even if the packing then has fewer balls than `count`.
  double min_radius_m{0.02e-3};
  double max_radius_m{1.0};  ///< largest radius at the cut zone and above
  /// Growth of the largest radius with the depth of the ball's centre below the cut zone [m/m].
  double grade{0.0};
  std::uint64_t seed{0};  ///< selects one of many equally good packings
  int threads{0};         ///< 0: one per core; the result does not depend on it
};

/// Fills a solid with disjoint balls; the largest ball that fits is placed first. This is the cutting paper's
/// packing. It represents the shape well, but a cut removes more bone from it than from overlapping balls
/// (packing_builder.h).
///
/// 1. Prototypes climb from the solid's thick places to local maxima of the clearance: the distance to the
///    surface or to the nearest ball (clearance_climb.h). The maxima are stored as holes, sorted by radius.
/// 2. Of the holes whose radii lie within 5 % of the largest, those that are still free are filled, larger
///    before smaller; holes whose radius is limited by the cap are filled from below. Prototypes then climb
///    beside each new ball (hole_search.h), and from the holes that a new ball overlaps. This repeats until
///    there are enough balls or no holes.
/// 3. Once no hole is left, the whole solid is searched for holes that the climbs missed. A packing that ends
///    with fewer than `count` balls therefore has no room for a ball of 1.02 times min_radius_m.
///
/// The order of filling is greedy up to the 5 % of step 2. Climbs run in parallel while no ball is added;
/// filling is serial and short. The result therefore depends on the arguments alone, not on the threads. The
/// balls are sorted along a Morton curve. A million balls take about 0.3 GB while they are computed.
///
/// Source of the idea: Weller, Zachmann, "ProtoSphere: A GPU-Assisted Prototype Guided Sphere Packing
/// Algorithm for Arbitrary Objects", SIGGRAPH Asia Sketches, 2010.
/// @returns `count` balls, or fewer if no more fit. Except for rounding, no ball protrudes from the solid or
///   overlaps another ball.
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildDisjointPacking(const Solid& solid, const CutZone& zone,
                                                     const DisjointParams& params);

}  // namespace osteon::simulation
