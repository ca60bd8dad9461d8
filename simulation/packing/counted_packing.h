#pragma once

#include <cstddef>
#include <vector>

#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {

/// What becomes finer where a scene's packing gets more balls.
enum class CountedGrade : std::uint8_t {
  kFixedZone,  ///< the bone below the cut zone; the zone keeps the balls that the scene gives it
  kUniform,    ///< all of the bone, everywhere alike: what the paper varies
};

/// A packing by its number of balls, for measurements over that number. Up to 10 million in a minute or so
/// and in less than 2 GB.
///
/// kFixedZone: as BuildPacking gives it where the count is at most its own (coarser everywhere for fewer).
/// Beyond that every ball whose centre lies less deep than the lattice's first level stays as it is, and the
/// bone below is filled by a body-centred lattice of spacing a, radius min(.8 a, distance to the surface),
/// where the distance is at least .3 a: overlapping without a hole, its outer face scalloped.
///
/// kUniform: one lattice of spacing a with balls of .8 a, and below the surface, at samples a / 2 apart, the
/// balls of up to that radius that touch it.
///
/// The result depends on the arguments alone, lies along a Morton curve, and no ball leaves the solid.
/// @param base   the scene's packing; its count is not looked at
/// @param count  1 … 100 million
/// @returns balls, their number within 2 % of `count` (kUniform: where 1000 and more are asked for).
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildCountedPacking(const Solid& solid, const CutZone& zone,
                                                    const PackingParams& base, std::size_t count,
                                                    CountedGrade grade);

/// Mean distance of the balls' centres where a bone is cut: cube root of its volume (by mass points) over the
/// centres up to `depth_m` below the zone. Zero where there is none.
[[nodiscard]] double MeanSpacing(const Bone& bone, const CutZone& zone, double depth_m);

}  // namespace osteon::simulation
