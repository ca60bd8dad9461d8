#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

#include "config/reading/load.h"

namespace osteon::app {

/// Parses "NAME[:DIAMETER]". NAME is a name under tools/ or a YAML file, DIAMETER one of the tool's diameters
/// in mm. The error names the wrong part, what was found and what is accepted.
[[nodiscard]] tl::expected<config::ToolChoice, std::string> ParseTool(
    const std::string& text, const std::filesystem::path& config_root);

}  // namespace osteon::app
