#pragma once

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include "config/reading/load.h"
#include "config/reading/strict/derived_file.h"

namespace osteon::config {

/// Text of a shipped cell, complete with all values of the cell that it extends. Files are named by absolute
/// paths, so the text can be loaded from any folder. Only the demo's text has its comments.
/// @param name  name of a cell under config/cells
inline std::string CellText(const std::string& name) {
  const std::filesystem::path shipped = OSTEON_SOURCE_DIR "/config/cells/" + name + ".yaml";
  const auto read = [](const std::filesystem::path& file) {
    std::ifstream stream(file);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  if (name == "demo") {
    std::string text = read(shipped);
    for (const std::string kind : {"robots", "tools", "scenes", "materials"}) {
      const std::string key = "\n" + (kind == "materials" ? kind : kind.substr(0, kind.size() - 1)) + ": ";
      const std::size_t at = text.find(key) + key.size(), end = text.find('\n', at);
      text.replace(at, end - at,
                   OSTEON_SOURCE_DIR "/config/" + kind + "/" + text.substr(at, end - at) + ".yaml");
    }
    return text;
  }
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("osteon_whole_cell_" + std::to_string(::getpid()) + ".yaml");
  WriteDerived(shipped, {}, file);
  std::string text = read(file);
  std::filesystem::remove(file);
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

/// The error of loading a text; empty if it is accepted.
inline std::string Refusal(const std::string& yaml) {
  try {
    static_cast<void>(LoadText(yaml));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

/// The text with the first occurrence of `before` replaced by `after`.
inline std::string With(std::string yaml, const std::string& before, const std::string& after) {
  const std::size_t at = yaml.find(before);
  if (at == std::string::npos) throw std::logic_error("the cell has changed: " + before);
  return yaml.replace(at, before.size(), after);
}

}  // namespace osteon::config
