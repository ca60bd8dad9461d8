#pragma once

#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// Removes balls of a tool as long as its surface changes by at most `gap_m`. The smallest balls are removed
/// first. Only cutting balls may replace cutting balls, and only touching balls may replace touching balls.
/// The head stays. A gap of 0 leaves the tool unchanged.
///
/// The surface is sampled at 200 points of each ball; points inside another ball of the same kind are left
/// out.
/// @throws std::invalid_argument if the gap is negative or not finite.
[[nodiscard]] Tool ThinTool(const Tool& tool, double gap_m);

/// Mean distance [m], weighted by area, from the cutting surface of `tool` to the cutting balls of `thin`;
/// surface points inside these balls count as 0.
[[nodiscard]] double MeanCuttingGap(const Tool& tool, const Tool& thin);

}  // namespace osteon::simulation
