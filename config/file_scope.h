#pragma once

#include <filesystem>
#include <vector>

namespace osteon::config {

/// While one lives, the files that a configuration is read from are noted, in this thread; and they may be
/// held to one folder, so that what a recording keeps can be read again with nothing else. One at a time in a
/// thread.
class FileScope {
 public:
  struct Params {
    /// Files are found below this folder and nowhere else. Empty: anywhere.
    std::filesystem::path root{};
    /// A file named by a whole path below this one is looked for at the same place below `root`.
    std::filesystem::path once_at{};
  };
  struct File {
    std::filesystem::path path;  ///< absolute
    bool by_whole_path{false};   ///< another file names it so
  };

  FileScope();
  explicit FileScope(Params params);
  ~FileScope();
  FileScope(const FileScope&) = delete;
  FileScope& operator=(const FileScope&) = delete;

  /// Each once, in the order in which they were first named.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }

  /// For Reader: a file that is read.
  static void Note(const std::filesystem::path& path, bool by_whole_path = false);
  /// For Reader: where a file lies that another one, in `folder`, names. Empty: not below the root.
  [[nodiscard]] static std::filesystem::path Find(const std::filesystem::path& folder,
                                                  const std::filesystem::path& named);

 private:
  Params params_;
  std::vector<File> files_;
};

}  // namespace osteon::config
