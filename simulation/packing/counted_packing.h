#pragma once

#include <cstddef>
#include <vector>

#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {

/// The part of a bone that becomes finer if its packing gets more balls.
enum class CountedGrade : std::uint8_t {
  kFixedZone,  ///< the bone below the cut zone; the zone keeps the scene's balls
  kUniform,    ///< the whole bone alike, as the paper varies it
};

/// Makes a packing with a given number of balls, to measure how results depend on that number. Up to 10
/// million balls in about a minute and in less than 2 GB.
///
/// kFixedZone: BuildPacking's packing where the count is at most its own (coarser everywhere for fewer
/// balls). Beyond that every ball with a centre less deep than the lattice's first level stays as it is. The
/// bone below is filled by a body-centred lattice of spacing a with radius min(0.8 a, distance to the
/// surface), where the distance is at least 0.3 a. The balls overlap without a hole; the outer face is
/// scalloped.
///
/// kUniform: one lattice of spacing a with balls of 0.8 a, and below the surface, at samples a / 2 apart, the
/// balls of up to that radius that touch it.
///
/// The result depends on the arguments alone and lies along a Morton curve; no ball leaves the solid.
/// @param base   the scene's packing; its count is ignored
/// @param count  1 … 100 million
/// @returns balls, their number within 2 % of `count` (kUniform: where `count` is at least 1000).
/// @throws std::invalid_argument naming the parameter, its value and what is accepted.
[[nodiscard]] std::vector<Ball> BuildCountedPacking(const Solid& solid, const CutZone& zone,
                                                    const PackingParams& base, std::size_t count,
                                                    CountedGrade grade);

/// Mean spacing of the balls' centres where a bone is cut: cube root of the volume (by mass points) per
/// centre, up to `depth_m` below the zone. Zero where there is no ball.
[[nodiscard]] double MeanSpacing(const Bone& bone, const CutZone& zone, double depth_m);

}  // namespace osteon::simulation
