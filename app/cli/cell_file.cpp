#include "app/cli/cell_file.h"

#include <fmt/format.h>

#include "config/reading/named_file.h"

namespace osteon::app {

tl::expected<std::filesystem::path, std::string> FindCell(const std::filesystem::path& config_root,
                                                          const std::string& name) {
  const std::filesystem::path cells = config_root / "cells";
  return config::FindNamedFile(cells, name).map_error([&](const std::filesystem::path& file) {
    return fmt::format("{}: no file {}; accepted: a YAML file, or one of {}: {}", name, file.string(),
                       cells.string(), config::YamlNamesIn(cells));
  });
}

}  // namespace osteon::app
