#pragma once

#include <filesystem>
#include <string>

#include "session/setup/cell_setup.h"

namespace osteon::app {

/// What the console shows that does not change in a run, as JSON (osteon.scene/1): bone, site, tool, arm,
/// zones, limits. Lengths in m, poses as rows of [R | p].
/// @param command, seconds, recording  of the run
[[nodiscard]] std::string ConsoleScene(const CellSetup& setup, const std::string& command, double seconds,
                                       const std::string& recording);

/// Folder of the console's built page: $OSTEON_CONSOLE, else beside this program (a build folder, an
/// installed package). It may not exist.
[[nodiscard]] std::filesystem::path ConsolePageFolder();

}  // namespace osteon::app
