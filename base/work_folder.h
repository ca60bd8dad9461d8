#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>

namespace osteon::base {

/// A new folder in the system's folder for temporary files, removed with the object.
class WorkFolder {
 public:
  /// @param what  a word for the folder's name
  explicit WorkFolder(const std::string& what) {
    std::string name = (std::filesystem::temp_directory_path() / ("osteon_" + what + "_XXXXXX")).string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  /// Empty if no folder could be made.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace osteon::base
