#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "simulation/bone/material.h"

namespace osteon::plugin {

/// The folder of scenes/, materials/ and tools/: the given one; else $OSTEON_ROOT/config; else, of the
/// folders above this library, the nearest with config/ (a checkout) or share/osteon/config/ (an
/// installation).
/// @param given  null: none
/// @throws Failure if there is none.
[[nodiscard]] std::filesystem::path ConfigFolder(const char* given);

/// Finds a shipped file by its name, or a file by its path. @param kind  "scenes", "tools"
/// @throws Failure with what was looked for, and the names that there are.
[[nodiscard]] std::filesystem::path FindShipped(const std::filesystem::path& config, const std::string& kind,
                                                const std::string& name);

/// Finds materials by their names, in the first file of materials/ that has all of them.
/// @throws Failure if no file has all of them.
[[nodiscard]] std::vector<simulation::Material> FindMaterials(const std::filesystem::path& config,
                                                              const std::vector<std::string>& names);

}  // namespace osteon::plugin
