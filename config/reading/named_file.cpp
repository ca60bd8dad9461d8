#include "config/reading/named_file.h"

#include <algorithm>
#include <system_error>

namespace osteon::config {

std::filesystem::path AbsolutePath(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

std::vector<std::filesystem::path> YamlFilesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

std::string YamlNamesIn(const std::filesystem::path& folder) {
  std::string names;
  for (const std::filesystem::path& file : YamlFilesIn(folder))
    names += (names.empty() ? "" : ", ") + file.stem().string();
  if (!names.empty()) return names;
  std::error_code error;
  return std::filesystem::is_directory(folder, error) ? "none"
                                                      : "none, since that folder is not there; OSTEON_ROOT "
                                                        "names the folder of Osteon, with config/ in it";
}

tl::expected<std::filesystem::path, std::filesystem::path> FindNamedFile(const std::filesystem::path& folder,
                                                                         const std::string& name) {
  std::error_code error;
  const bool has_extension = name.ends_with(".yaml");
  const std::filesystem::path named(has_extension ? name : name + ".yaml"), inside = folder / named;
  if (has_extension && std::filesystem::is_regular_file(named, error)) return named;
  if (!named.has_parent_path() && std::filesystem::is_regular_file(inside, error)) return inside;
  return tl::make_unexpected(has_extension ? named : inside);
}

}  // namespace osteon::config
