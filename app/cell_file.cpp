#include "app/cell_file.h"

#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace osteon::app {
namespace {

// In alphabetical order.
std::string CellNames(const std::filesystem::path& cells) {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(cells, error))
    if (entry.path().extension() == ".yaml") names.insert(entry.path().stem().string());
  return names.empty() ? "there is none" : fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

tl::expected<std::filesystem::path, std::string> FindCell(const std::filesystem::path& config_root,
                                                          const std::string& name) {
  const std::filesystem::path cells = config_root / "cells";
  std::filesystem::path file =
      name.ends_with(".yaml") ? std::filesystem::path(name) : cells / (name + ".yaml");
  if (std::filesystem::is_regular_file(file)) return file;
  if (!file.has_parent_path() && std::filesystem::is_regular_file(cells / file)) return cells / file;
  return tl::make_unexpected(fmt::format("{}: no file {}; accepted: a YAML file, or one of {}: {}", name,
                                         file.string(), cells.string(), CellNames(cells)));
}

}  // namespace osteon::app
