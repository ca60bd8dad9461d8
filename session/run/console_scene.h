#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "console/stream/live_status.h"
#include "session/setup/cell_setup.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// What the console shows that does not change in a run, as JSON (osteon.scene/1): bone, site, tool, arm,
/// zones, limits. Lengths in m, poses as rows of [R | p].
/// @param command, seconds, recording  of the run
/// @param tools  by the index that the ticks name; empty: the cell's own alone
[[nodiscard]] std::string ConsoleScene(const CellSetup& setup, const std::string& command, double seconds,
                                       const std::string& recording,
                                       std::span<const simulation::Tool> tools = {});

/// The cell's force limit, and the depth at a proxy pose where the bone has balls.
[[nodiscard]] console::LiveContext LiveContextOf(const CellSetup& setup);

/// Folder of the console's built page: $OSTEON_CONSOLE, else beside this program (a build folder, an
/// installed package). It may not exist.
[[nodiscard]] std::filesystem::path ConsolePageFolder();

}  // namespace osteon::session
