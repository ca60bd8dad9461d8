#include "app/cli/usage/cell_file.h"

#include <system_error>

#include <fmt/format.h>

#include "config/reading/named_file.h"

namespace osteon::app {

tl::expected<std::filesystem::path, std::string> FindCell(const std::filesystem::path& config_root,
                                                          const std::string& name) {
  const std::filesystem::path cells = config_root / "cells";
  return config::FindNamedFile(cells, name).map_error([&](const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(name, error))
      return fmt::format("{}: found a folder; accepted: a YAML file, or one of {}: {}", name, cells.string(),
                         config::YamlNamesIn(cells));
    const std::string with_ending = name + ".yaml";
    return fmt::format(
        "{}: no file {}{}; accepted: a YAML file, or one of {}: {}", name, file.string(),
        std::filesystem::is_regular_file(with_ending, error) ? "; did you mean " + with_ending + "?" : "",
        cells.string(), config::YamlNamesIn(cells));
  });
}

}  // namespace osteon::app
