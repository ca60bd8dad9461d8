#pragma once

#include "simulation/tool.h"

namespace osteon::simulation {

/// A tool with as few of its balls as leave its surface where it is, to within `gap_m`: the smallest are
/// taken out first, balls that cut stand for balls that cut and the others for the others, the head stays. At
/// a gap of 0 it is the tool as it is.
///
/// The surface is looked at in 200 places of each ball that no other ball of its kind covers.
/// @throws std::invalid_argument where the gap is negative or not finite.
[[nodiscard]] Tool ThinTool(const Tool& tool, double gap_m);

/// Mean distance from the cutting surface of a tool, by area, to the cutting balls of another [m]; 0 where
/// these hold it.
[[nodiscard]] double MeanCuttingGap(const Tool& tool, const Tool& thin);

}  // namespace osteon::simulation
