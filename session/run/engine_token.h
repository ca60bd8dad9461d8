#pragma once

#include <filesystem>
#include <string>

#include <tl/expected.hpp>

namespace osteon::session {

/// Reads the token that an engine on another machine demands from a run. It is the file's first line, 16 to
/// 256 characters. The error names the file, what was found and what is accepted.
[[nodiscard]] tl::expected<std::string, std::string> ReadEngineToken(const std::filesystem::path& file);

}  // namespace osteon::session
