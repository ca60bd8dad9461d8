#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

namespace osteon::app {

/// Finds the surgical plan that a user named: a YAML file, or a name under plans/ of the configuration's
/// root. The error lists the available plans.
[[nodiscard]] tl::expected<std::filesystem::path, std::string> FindPlan(
    const std::filesystem::path& config_root, const std::string& name);

}  // namespace osteon::app
