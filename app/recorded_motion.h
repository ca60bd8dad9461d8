#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"
#include "simulation/tools/motion_player.h"

namespace osteon::app {

/// The tool's motion of a recorded run, for a motion file: of each tick from the first that rendered to the
/// last before rest, the *commanded* tool pose relative to the bone, thinned out (simulation::FitMotion).
/// One message of the recording at a time is in memory, and of each such tick the pose (72 bytes).
/// @param origin  all but `error`, which is written here
/// The error names the file and what is wrong with it, or says what was found, where the run never rendered
/// or is too long for a file.
[[nodiscard]] tl::expected<simulation::ToolMotion, std::string> RecordedMotion(
    const std::filesystem::path& recording, const Pose& X_WG, simulation::MotionOrigin origin);

}  // namespace osteon::app
