#pragma once

#include <filesystem>
#include <span>

namespace osteon::config {

/// The nearest folder above a program or library that has the shipped files: config/ (a checkout, or an
/// add-on) or share/osteon/config/ (an installation). Empty: there is none.
/// @param has  folders that it must contain, to tell it from other folders of its name: "scenes", "tools"
[[nodiscard]] std::filesystem::path FindShippedAbove(const std::filesystem::path& file,
                                                     std::span<const char* const> has);

/// Whether a folder has subfolders of all these names.
[[nodiscard]] bool HasFolders(const std::filesystem::path& folder, std::span<const char* const> has);

}  // namespace osteon::config
