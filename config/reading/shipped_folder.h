#pragma once

#include <filesystem>
#include <span>

namespace osteon::config {

/// Finds the folder with the shipped files: the nearest config/ (in a checkout or an add-on) or
/// share/osteon/config/ (in an installation) above the file of a program or library. Empty: there is none.
/// @param has  subfolders that the folder must contain, since other folders may have the same name: "scenes",
///   "tools"
[[nodiscard]] std::filesystem::path FindShippedAbove(const std::filesystem::path& file,
                                                     std::span<const char* const> has);

/// Whether a folder has subfolders of all these names.
[[nodiscard]] bool HasFolders(const std::filesystem::path& folder, std::span<const char* const> has);

}  // namespace osteon::config
