#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::plugin {

/// Finds the folder that contains scenes/, materials/ and tools/: the given folder; else $OSTEON_ROOT/config;
/// else config/ (a checkout) or share/osteon/config/ (an installation) in the nearest folder above this
/// library that has one of them.
/// @param given  the caller's folder; null: none
/// @throws Failure if there is none.
[[nodiscard]] std::filesystem::path ConfigFolder(const char* given);

/// Finds a shipped file by its name, or a file by its path. @param kind  "scenes", "tools"
/// @throws Failure naming the file that was looked for, and the existing names.
[[nodiscard]] std::filesystem::path FindShipped(const std::filesystem::path& config, const std::string& kind,
                                                const std::string& name);

/// Finds materials by their names, in the first file of materials/ that has all of them.
/// @throws Failure if no file has all of them.
[[nodiscard]] std::vector<simulation::Material> FindMaterials(const std::filesystem::path& config,
                                                              const std::vector<std::string>& names);

}  // namespace osteon::plugin
