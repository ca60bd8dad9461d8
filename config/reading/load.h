#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

// One function for each kind of file under config/ (robots: load_robot.h). Each checks every value against
// its accepted range, and values against each other; paths in a file are relative to its own folder. All
// throw ConfigError.

namespace osteon::config {

/// A size that a tool does not come in: "found …, accepted …". The caller knows where it was requested.
class ToolSizeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// @param diameter_m  one of the sizes that the file lists; none: the file's default
/// @throws ToolSizeError if the tool does not come in that size.
[[nodiscard]] ToolConfig LoadTool(const std::filesystem::path& path,
                                  const std::optional<double>& diameter_m = {});

/// A tool that replaces the cell's.
struct ToolChoice {
  std::filesystem::path file;
  std::optional<double> diameter_m{};
};
/// Loads 1 … 8 materials of different names, in the file's order; each value has its source, or is marked as
/// assumed.
[[nodiscard]] std::vector<simulation::Material> LoadMaterials(const std::filesystem::path& path);
/// Loads shape, site and resolution, and the names of the needed materials; the materials stay empty.
[[nodiscard]] simulation::SceneParams LoadScene(const std::filesystem::path& path);
/// Loads a cell and the robot, tool, scene and materials that it names.
/// @param gains  a file with gains that override the cell's (ApplyGainsFile); empty: none
/// @throws ToolSizeError if `tool` does not come in the requested size.
[[nodiscard]] CellConfig LoadCell(const std::filesystem::path& path,
                                  const std::optional<ToolChoice>& tool = {},
                                  const std::filesystem::path& gains = {});

/// Refuses a cell without `operator`, `script` and `simulated_arm`, for a command that simulates it.
/// @param path  of its file  @throws ConfigError
void RequireSimulation(const CellConfig& cell, const std::filesystem::path& path);

}  // namespace osteon::config
