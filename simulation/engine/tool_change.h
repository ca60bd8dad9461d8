#pragma once

#include "kinematics/spatial.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

// For a change of tool on a carved bone: whether the tool is clear of bone, and the state from which another
// tool's engine continues.

namespace osteon::simulation {

/// Smallest gap between the tool's balls and the remaining bone balls [m]; negative: how far the tool is in
/// bone. Infinite if no bone is left.
[[nodiscard]] double ToolClearance(const CarvedState& state, const Tool& tool, const Pose& X_GT);

/// Returns a carved state without proxy and contact memory, which refer to the former tool. An engine that
/// continues from this state, with another tool or at another place, begins at the tool pose of its first
/// frame.
[[nodiscard]] CarvedState WithoutContact(CarvedState state);

}  // namespace osteon::simulation
