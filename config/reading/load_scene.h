#pragma once

#include <filesystem>

#include "config/reading/strict/config_error.h"
#include "simulation/bone/scenes.h"

namespace osteon::config {

/// Loads shape, site and resolution, and the names of the needed materials; the materials stay empty.
/// Paths in the file are relative to its folder.
/// @throws ConfigError
[[nodiscard]] simulation::SceneParams LoadScene(const std::filesystem::path& path);

}  // namespace osteon::config
