#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace osteon::config {

/// A kind of YAML file that the program reads.
struct FileKind {
  std::string name;    ///< "cell"
  std::string folder;  ///< under config/; empty: none
  /// Reads a file of this kind and drops its content. @throws ConfigError
  std::function<void(const std::filesystem::path&)> load;
};
/// All kinds of YAML files.
[[nodiscard]] std::vector<FileKind> FileKinds();

}  // namespace osteon::config
