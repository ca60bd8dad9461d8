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

/// A tool of a procedure, with the data that the simulation and the servo loop need.
struct ProcedureTool {
  double diameter_m{0.0};
  simulation::Tool tool;
  control::LoopTool loop;
};

/// Returns the member `tool` of each procedure tool.
[[nodiscard]] std::vector<simulation::Tool> ToolsOf(std::span<const ProcedureTool> tools);

/// The tools of a procedure, in the form that a recording stores.
struct ToolList {
  std::vector<double> diameters_mm;
  int first{0};  ///< index of the tool in use at the recording's beginning
  /// A change mounts another real tool. False: the mounted handle stays, and mass and payload with it.
  bool physical{false};
  std::vector<control::GuidanceParams> guidance{};  ///< one for each tool; empty: the plan has none
};

/// Loads the cell with each of the tools in turn.
/// @param base  the cell with one of these tools loaded
/// @param tool_file  file of the tool, which must come in each of the list's sizes
/// @param gains  as for LoadCell
/// @throws config::ConfigError; config::ToolSizeError if the tool does not come in one of the sizes.
[[nodiscard]] std::vector<ProcedureTool> LoadProcedureTools(const config::CellConfig& base,
                                                            const std::filesystem::path& cell_yaml,
                                                            const std::filesystem::path& tool_file,
                                                            const std::filesystem::path& gains,
                                                            const ToolList& list);

/// Prepares the loop's parameters for all tools: the age governor's radius becomes that of the largest
/// cutting head among the tools.
void PrepareForTools(const std::vector<ProcedureTool>& tools, config::CellConfig& cell);
/// Gives the loop its table of tools, with the tool `first` in use.
void SetTools(const std::vector<ProcedureTool>& tools, int first, control::ServoLoop& loop);

/// Adds the list to a recording's configuration, as a file of its own.
void KeepToolList(const ToolList& list, io::ConfigSource& source);
/// Reads the list from a recording's configuration; empty: a recording with one tool. The error says what is
/// wrong with the list.
[[nodiscard]] tl::expected<std::optional<ToolList>, std::string> FindToolList(const io::ConfigSource& source);

}  // namespace osteon::session
