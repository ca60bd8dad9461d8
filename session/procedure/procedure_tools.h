#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/cell_config.h"
#include "control/loop/servo_loop.h"
#include "control/setup/loop_tool.h"
#include "io/recording/messages.h"
#include "simulation/tools/tool.h"

namespace osteon::session {

/// A tool of a procedure: what the simulation and what the servo loop has to know of it.
struct ProcedureTool {
  double diameter_m{0.0};
  simulation::Tool tool;
  control::LoopTool loop;
};

/// The simulation's part of each tool.
[[nodiscard]] std::vector<simulation::Tool> ToolsOf(std::span<const ProcedureTool> tools);

/// The tools of a procedure, as a recording keeps them.
struct ToolList {
  std::vector<double> diameters_mm;
  int first{0};          ///< in use at the recording's beginning
  bool physical{false};  ///< another tool is mounted; false: the handle stays, and with it mass and payload
  std::vector<control::GuidanceParams> guidance{};  ///< of each tool; empty: the plan has none
};

/// Loads the cell with each of the tools in turn.
/// @param base  the cell as it runs, with one of these tools
/// @param tool_file  of all sizes  @param gains  as for LoadCell
/// @throws config::ConfigError; config::ToolSizeError if the tool does not come in one of the sizes.
[[nodiscard]] std::vector<ProcedureTool> LoadProcedureTools(const config::CellConfig& base,
                                                            const std::filesystem::path& cell_yaml,
                                                            const std::filesystem::path& tool_file,
                                                            const std::filesystem::path& gains,
                                                            const ToolList& list);

/// What the loop's parameters need for all tools of a table: the age governor counts with the largest head.
void PrepareForTools(const std::vector<ProcedureTool>& tools, config::CellConfig& cell);
/// Gives a loop the table, with the tool `first` in use.
void SetTools(const std::vector<ProcedureTool>& tools, int first, control::ServoLoop& loop);

/// Keeps the list among a recording's configuration, under a name of its own.
void KeepToolList(const ToolList& list, io::ConfigSource& source);
/// Finds it there; absent: a recording of one tool. The error says what is wrong with it.
[[nodiscard]] tl::expected<std::optional<ToolList>, std::string> FindToolList(const io::ConfigSource& source);

}  // namespace osteon::session
