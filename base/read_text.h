#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace osteon::base {

/// Returns a file's bytes; empty if it cannot be read.
[[nodiscard]] inline std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace osteon::base
