#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace osteon::config {

/// A kind of YAML file.
struct FileKind {
  std::string name;    ///< "cell"
  std::string folder;  ///< under config/; empty: none
  std::function<void(const std::filesystem::path&)> load;
};
/// All kinds of YAML files.
[[nodiscard]] std::vector<FileKind> FileKinds();

}  // namespace osteon::config
