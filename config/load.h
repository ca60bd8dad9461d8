#pragma once

#include <filesystem>
#include <vector>

#include "config/cell_config.h"
#include "config/reader.h"

// One function for each kind of file under config/. Each checks every value against its accepted range, and
// values against each other; paths inside a file start from its own folder. All throw ConfigError.

namespace osteon::config {

[[nodiscard]] kinematics::LbrParams LoadRobot(const std::filesystem::path& path);
[[nodiscard]] ToolConfig LoadTool(const std::filesystem::path& path);
/// 1 … 8 materials of different names, in the file's order; each figure with its source, or marked as
/// assumed.
[[nodiscard]] std::vector<simulation::Material> LoadMaterials(const std::filesystem::path& path);
/// Shape, site and fineness, and the names of the materials that are needed; the materials stay empty.
[[nodiscard]] simulation::SceneParams LoadScene(const std::filesystem::path& path);
/// A cell and the robot, tool, scene and materials that it names.
[[nodiscard]] CellConfig LoadCell(const std::filesystem::path& path);

}  // namespace osteon::config
