#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <vector>

#include "config/cell_config.h"
#include "config/reader.h"

// One function for each kind of file under config/ (robots: load_robot.h). Each checks every value against
// its accepted range, and values against each other; paths inside a file start from its own folder. All throw
// ConfigError.

namespace osteon::config {

/// A size that a tool does not come in: "found …, accepted …". Who asked for it knows where.
class ToolSizeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// @param diameter_m  one of the sizes that the file lists; none: the file's default
/// @throws ToolSizeError where the tool does not come in that size.
[[nodiscard]] ToolConfig LoadTool(const std::filesystem::path& path,
                                  const std::optional<double>& diameter_m = {});

/// A tool to take instead of the cell's.
struct ToolChoice {
  std::filesystem::path file;
  std::optional<double> diameter_m{};
};
/// 1 … 8 materials of different names, in the file's order; each figure with its source, or marked as
/// assumed.
[[nodiscard]] std::vector<simulation::Material> LoadMaterials(const std::filesystem::path& path);
/// Shape, site and fineness, and the names of the materials that are needed; the materials stay empty.
[[nodiscard]] simulation::SceneParams LoadScene(const std::filesystem::path& path);
/// A cell and the robot, tool, scene and materials that it names.
/// @param gains  a file with gains to lay over the cell's (LayGainsOver); empty: none
/// @throws ToolSizeError where `tool` does not come in the size asked for.
[[nodiscard]] CellConfig LoadCell(const std::filesystem::path& path,
                                  const std::optional<ToolChoice>& tool = {},
                                  const std::filesystem::path& gains = {});

}  // namespace osteon::config
