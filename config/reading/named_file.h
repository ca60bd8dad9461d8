#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace osteon::config {

/// The absolute path of a file, without "." and "..".
[[nodiscard]] std::filesystem::path AbsolutePath(const std::filesystem::path& path);

/// The YAML files of a folder, sorted by name; none if the folder cannot be read.
[[nodiscard]] std::vector<std::filesystem::path> YamlFilesIn(const std::filesystem::path& folder);

/// Names of the YAML files in a folder without ".yaml", separated by commas, or "none". If the folder does
/// not exist, the text says how to name it.
[[nodiscard]] std::string YamlNamesIn(const std::filesystem::path& folder);

/// Finds a file as a user names it: the path of a YAML file, or its name in `folder`, with ".yaml" or
/// without. A path takes precedence over a name.
/// @returns the file, or as the error the path that does not exist
[[nodiscard]] tl::expected<std::filesystem::path, std::filesystem::path> FindNamedFile(
    const std::filesystem::path& folder, const std::string& name);

}  // namespace osteon::config
