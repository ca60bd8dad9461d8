#pragma once

#include <cstddef>
#include <vector>

#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {

/// The part of a bone that becomes finer if its packing gets more balls.
enum class CountedGrade : std::uint8_t {
  kFixedZone,  ///< the bone below the cut zone; the zone keeps the scene's balls
  kUniform,    ///< the whole bone, with the same spacing everywhere, as in the cutting paper
};

/// Makes a packing with a given number of balls, to measure how results depend on that number. 10 million
/// balls take about a minute and less than 2 GB.
///
/// kFixedZone: if `count` is at most the number of balls that BuildPacking makes with `base`, the packing is
/// BuildPacking's, coarser everywhere for a smaller count. For a larger count, every ball of that packing
/// whose centre is above the depth of the lattice's first coarser level stays. The bone below is filled by a
/// body-centred lattice of spacing a, with balls of radius min(0.8 a, distance to the surface) at sites at
/// least 0.3 a from the surface. These balls leave no hole between them, but a scalloped outer face.
///
/// kUniform: one lattice of spacing a with balls of radius 0.8 a. In addition, at surface samples a / 2
/// apart, balls of at most this radius that touch the surface from inside.
///
/// The result depends on the arguments alone and lies along a Morton curve; no ball leaves the solid.
/// @param base   the scene's packing; its own count is ignored
/// @param count  1 … 100 million
/// @returns balls, their number within 2 % of `count` (kUniform: where `count` is at least 1000).
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildCountedPacking(const Solid& solid, const CutZone& zone,
                                                    const PackingParams& base, std::size_t count,
                                                    CountedGrade grade);

/// Mean spacing of the balls' centres in the part of a bone that is cut, up to `depth_m` below the zone: the
/// cube root of volume (of the mass points) per centre. Zero if there is no ball.
[[nodiscard]] double MeanSpacing(const Bone& bone, const CutZone& zone, double depth_m);

}  // namespace osteon::simulation
