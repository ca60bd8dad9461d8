#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace osteon::config {

/// Text of a shipped cell's file with the files that it names by whole paths, so that it may be read from any
/// folder. @param name  under config/cells
inline std::string CellText(const std::string& name) {
  std::ifstream stream(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml");
  std::string text(std::istreambuf_iterator<char>(stream), {});
  for (std::size_t at = 0; (at = text.find(": ../", at)) != std::string::npos;)
    text.replace(at, 5, ": " OSTEON_SOURCE_DIR "/config/");
  return text;
}

}  // namespace osteon::config
