#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>

#include "config/reading/strict/config_error.h"
#include "config/reading/tool_config.h"

namespace osteon::config {

/// The error for a size that a tool does not have: "found …, accepted …". The caller must add where the size
/// was requested.
class ToolSizeError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Loads a tool. Checks every value against its accepted range; paths in the file are relative to its folder.
/// @param diameter_m  one of the sizes that the file lists; none: the file's default
/// @throws ConfigError; ToolSizeError if the tool does not come in that size.
[[nodiscard]] ToolConfig LoadTool(const std::filesystem::path& path,
                                  const std::optional<double>& diameter_m = {});

}  // namespace osteon::config
