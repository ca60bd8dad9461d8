#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "config/load.h"

namespace osteon::config {

/// Text of a shipped cell's file, with whole paths for the files that it names, so that it can be read from
/// any folder. @param name  under config/cells
inline std::string CellText(const std::string& name) {
  std::ifstream stream(OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml");
  std::string text(std::istreambuf_iterator<char>(stream), {});
  for (std::size_t at = 0; (at = text.find(": ../", at)) != std::string::npos;)
    text.replace(at, 5, ": " OSTEON_SOURCE_DIR "/config/");
  return text;
}

/// Loads a cell from a text, through a temporary file.
inline CellConfig LoadText(const std::string& yaml) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("osteon_cell_text_" + std::to_string(::getpid()) + ".yaml");
  std::ofstream(file) << yaml;
  try {
    CellConfig cell = LoadCell(file);
    std::filesystem::remove(file);
    return cell;
  } catch (...) {
    std::filesystem::remove(file);
    throw;
  }
}

/// Error of a text; empty if it is accepted.
inline std::string Refusal(const std::string& yaml) {
  try {
    static_cast<void>(LoadText(yaml));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// The text with the first `before` replaced.
inline std::string With(std::string yaml, const std::string& before, const std::string& after) {
  const std::size_t at = yaml.find(before);
  if (at == std::string::npos) throw std::logic_error("the cell has changed: " + before);
  return yaml.replace(at, before.size(), after);
}

}  // namespace osteon::config
