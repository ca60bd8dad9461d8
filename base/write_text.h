#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

namespace osteon::base {

/// Writes text to a file, which appears complete or not at all. A symbolic link stays a link: its target is
/// written. An existing file keeps its permissions. The error names the path.
[[nodiscard]] tl::expected<void, std::string> WriteText(const std::filesystem::path& path,
                                                        const std::string& text);

}  // namespace osteon::base
