#include "config/reading/shipped_folder.h"

#include <algorithm>
#include <system_error>

namespace osteon::config {

bool HasFolders(const std::filesystem::path& folder, std::span<const char* const> has) {
  return std::all_of(has.begin(), has.end(), [&](const char* name) {
    std::error_code error;
    return std::filesystem::is_directory(folder / name, error);
  });
}

std::filesystem::path FindShippedAbove(const std::filesystem::path& file, std::span<const char* const> has) {
  for (std::filesystem::path above = file; above.has_relative_path();) {
    above = above.parent_path();
    for (const char* below : {"config", "share/osteon/config"})
      if (HasFolders(above / below, has)) return above / below;
  }
  return {};
}

}  // namespace osteon::config
