#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::config {

/// A path from the root, without "." and "..".
[[nodiscard]] std::filesystem::path AbsolutePath(const std::filesystem::path& path);

/// The YAML files of a folder, sorted by name; none if the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> YamlFilesIn(const std::filesystem::path& folder);

/// Their names without ".yaml", separated by commas, or "none"; where there is no such folder, how to name
/// it.
[[nodiscard]] std::string YamlNamesIn(const std::filesystem::path& folder);

/// Finds a file as a user names it: the path of a YAML file, or its name in `folder`, with ".yaml" or
/// without. A path takes precedence over a name.
/// @returns as the error, the file that was looked for
[[nodiscard]] tl::expected<std::filesystem::path, std::filesystem::path> FindNamedFile(
    const std::filesystem::path& folder, const std::string& name);

}  // namespace osteon::config
