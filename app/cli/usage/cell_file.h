#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

namespace osteon::app {

/// Finds the cell that a user named: a YAML file, or a name under cells/ of the configuration's root. The
/// error lists the available cells.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> FindCell(
    const std::filesystem::path& config_root, const std::string& name);

}  // namespace osteon::app
