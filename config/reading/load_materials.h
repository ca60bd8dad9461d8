#pragma once

#include <filesystem>
#include <vector>

#include "config/reading/strict/config_error.h"
#include "simulation/bone/material.h"

namespace osteon::config {

/// Loads 1 … 8 materials of different names, in the file's order; each value has its source, or is marked as
/// assumed.
/// @throws ConfigError
[[nodiscard]] std::vector<simulation::Material> LoadMaterials(const std::filesystem::path& path);

}  // namespace osteon::config
