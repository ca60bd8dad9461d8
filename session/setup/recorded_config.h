#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/config_file_tracker.h"
#include "config/reading/load.h"
#include "control/loop/servo_loop.h"
#include "io/recording/messages.h"
#include "session/procedure/procedure_tools.h"

namespace osteon::session {

/// Reads the files that a cell was just loaded from, in their present state, for its recording.
/// @param scope  knows which files were read; must have existed while the cell was loaded The error names a
/// file that can no longer be read.
[[nodiscard]] tl::expected<io::ConfigSource, std::string> KeepConfig(
    const config::ConfigFileTracker& scope, const std::filesystem::path& cell_yaml,
    const std::optional<config::ToolChoice>& tool, const std::filesystem::path& gains,
    const std::filesystem::path& identified = {});

/// Loads the cell with which a recording was made, from the recording only. Its files lie in a temporary
/// folder during the call. The error says what is missing or wrong: a recording without configuration, a name
/// that leads out of the folder, a file that this version does not accept.
[[nodiscard]] tl::expected<config::CellConfig, std::string> LoadRecordedCell(const io::ConfigSource& source);

/// A recording's cell with the tools of its procedure.
struct RecordedCell {
  config::CellConfig config;  ///< the cell's configuration, prepared for all tools
  ToolList list;              ///< the tools; empty: the cell's own tool only
  std::vector<ProcedureTool> tools;
};
/// Loads the cell from the recording only (LoadRecordedCell), and a procedure's table of tools.
[[nodiscard]] tl::expected<RecordedCell, std::string> LoadRecordedTools(const io::ConfigSource& source);

/// Makes a cell's servo loop, in the same way for a run and for its replay.
[[nodiscard]] control::ServoLoop MakeServoLoop(const config::CellConfig& cell);

}  // namespace osteon::session
