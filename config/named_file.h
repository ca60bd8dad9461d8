#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::config {

/// The YAML files of a folder, by their names' order; none where it can not be read.
[[nodiscard]] std::vector<std::filesystem::path> YamlFilesIn(const std::filesystem::path& folder);

/// Their names without ".yaml", with commas between them, or "none".
[[nodiscard]] std::string YamlNamesIn(const std::filesystem::path& folder);

/// A file as a user names it: the path of a YAML file, or its name in `folder`, with ".yaml" or without. A
/// path counts before a name.
/// @returns in the error the file that was looked for
[[nodiscard]] tl::expected<std::filesystem::path, std::filesystem::path> FindNamedFile(
    const std::filesystem::path& folder, const std::string& name);

}  // namespace osteon::config
