#pragma once

#include <filesystem>
#include <optional>

#include "config/reading/cell_config.h"
#include "config/reading/load_materials.h"
#include "config/reading/load_scene.h"
#include "config/reading/load_tool.h"
#include "config/reading/strict/reader.h"

// Loads a cell with all files that it names. The other kinds of files under config/ have their own headers
// load_*.h. Each loader checks every value against its accepted range, and values against each other. Paths
// in a file are relative to the folder of that file. All loaders throw ConfigError.

namespace osteon::config {

/// A tool that replaces the one that the cell's file names.
struct ToolChoice {
  std::filesystem::path file;
  std::optional<double> diameter_m{};
};
/// Loads a cell and the robot, tool, scene and materials that it names.
/// @param gains  a file with gains that override the cell's (ApplyGainsFile); empty: none
/// @param identified  a file of `osteon identify` in place of the cell's own (ApplyIdentified); empty: the
///   cell's own file, if it names one
/// @throws ToolSizeError if `tool` does not come in the requested size.
[[nodiscard]] CellConfig LoadCell(const std::filesystem::path& path,
                                  const std::optional<ToolChoice>& tool = {},
                                  const std::filesystem::path& gains = {},
                                  const std::filesystem::path& identified = {});

/// Error text for a cell that is to be simulated but has no `operator`, `script` and `simulated_arm`.
inline constexpr const char* kWithoutSimulation =
    "found a cell without operator, script and simulated_arm, accepted one with them: it is to be simulated. "
    "A real cell is tried on the one that it extends";
/// Refuses a cell without `operator`, `script` and `simulated_arm`, for a command that simulates it.
/// @param path  of its file  @throws ConfigError
void RequireSimulation(const CellConfig& cell, const std::filesystem::path& path);

}  // namespace osteon::config
