#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <tl/expected.hpp>

#include "config/file_scope.h"
#include "config/load.h"
#include "control/servo_loop.h"
#include "io/recording/messages.h"

namespace osteon::app {

/// The files that a cell was just loaded from, as they are now, for its recording.
/// @param scope  alive while the cell was loaded
/// The error names a file that can not be read any more.
[[nodiscard]] tl::expected<io::ConfigSource, std::string> KeepConfig(
    const config::FileScope& scope, const std::filesystem::path& cell_yaml,
    const std::optional<config::ToolChoice>& tool, const std::filesystem::path& gains);

/// The cell that a recording was made with, from what the recording holds and nothing else. Its files lie in
/// a temporary folder while this runs. The error says what is missing or wrong: a recording without
/// configuration, a name that leads out of the folder, a file that this version does not accept.
[[nodiscard]] tl::expected<config::CellConfig, std::string> LoadRecordedCell(const io::ConfigSource& source);

/// The servo loop of a cell, as a run and its replay make it.
[[nodiscard]] control::ServoLoop MakeServoLoop(const config::CellConfig& cell);

}  // namespace osteon::app
