#pragma once

#include "kinematics/spatial.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

// What a change of tool on a carved bone needs: whether the tool is clear, and the state that another tool's
// engine continues from.

namespace osteon::simulation {

/// Smallest gap between a tool's balls and the remaining bone's [m]; negative: how far the tool is in bone.
/// Infinite where no bone is left.
[[nodiscard]] double ToolClearance(const CarvedState& state, const Tool& tool, const Pose& X_GT);

/// A carved state without proxy and contact memory, which index the balls of the tool before: an engine with
/// another tool, or at another place, begins where its first frame finds the tool.
[[nodiscard]] CarvedState WithoutContact(CarvedState state);

}  // namespace osteon::simulation
