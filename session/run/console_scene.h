#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "console/stream/live_status.h"
#include "session/setup/cell_setup.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// Makes the JSON (osteon.scene/1) of everything on the console that does not change during a run: bone,
/// site, tool, arm, zones, limits. Lengths are in m, poses are rows of [R | p].
/// @param command, seconds, recording  command, requested duration and recording of the run
/// @param tools  in the order of TickInput::tool_index; empty: only the cell's own tool
[[nodiscard]] std::string ConsoleScene(const CellSetup& setup, const std::string& command, double seconds,
                                       const std::string& recording,
                                       std::span<const simulation::Tool> tools = {});

/// Makes the context of a cell's live views: its limits, and the depth at a proxy pose if the bone has balls.
[[nodiscard]] console::LiveContext LiveContextOf(const CellSetup& setup);

/// Returns the folder of the console's built page: $OSTEON_CONSOLE or, without it, a folder beside this
/// program (in a build folder or an installed package). The folder may not exist.
[[nodiscard]] std::filesystem::path ConsolePageFolder();

}  // namespace osteon::session
