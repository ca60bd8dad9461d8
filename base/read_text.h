#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

namespace osteon::base {

/// Returns a file's bytes; empty if it cannot be read, or is a folder.
[[nodiscard]] inline std::string ReadText(const std::filesystem::path& file) {
  std::error_code error;  // checked first: a folder can be opened, but reading its first byte throws
  if (std::filesystem::is_directory(file, error)) return {};
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace osteon::base
