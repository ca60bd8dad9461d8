#pragma once

#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// Reduces a tool to the balls that keep its surface to within `gap_m`. The smallest balls are removed first.
/// Only cutting balls may stand for cutting balls, and only other balls for other balls. The head stays. A
/// gap of 0 leaves the tool unchanged.
///
/// The surface is sampled at 200 places of each ball, without those that another ball of its kind covers.
/// @throws std::invalid_argument where the gap is negative or not finite.
[[nodiscard]] Tool ThinTool(const Tool& tool, double gap_m);

/// Mean distance [m], weighted by area, from the cutting surface of a tool to the cutting balls of another; 0
/// where these contain it.
[[nodiscard]] double MeanCuttingGap(const Tool& tool, const Tool& thin);

}  // namespace osteon::simulation
