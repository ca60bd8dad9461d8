#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "kinematics/spatial.h"
#include "simulation/tools/motion_player.h"

namespace osteon::session {

/// Extracts the tool's motion from a recorded run, for a motion file: the *commanded* tool pose relative to
/// the bone in each tick from the first tick that rendered to the last one before the arm came to rest,
/// thinned out (simulation::FitMotion). Memory holds one message of the recording at a time, and the pose of
/// each such tick (72 bytes).
/// @param origin  all fields except `error`, which is filled in here
/// The error names the file and what is wrong with it. A run that never rendered, or is too long for a file,
/// is an error that says what was found.
[[nodiscard]] tl::expected<simulation::ToolMotion, std::string> RecordedMotion(
    const std::filesystem::path& recording, const Pose& X_WG, simulation::MotionOrigin origin);

}  // namespace osteon::session
