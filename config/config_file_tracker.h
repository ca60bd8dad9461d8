#pragma once

#include <filesystem>
#include <vector>

namespace osteon::config {

/// While an object exists, records the files that this thread reads a configuration from. It may also
/// restrict them to one folder, so that the files in a recording can be read again without any other. At most
/// one in a thread at a time.
class ConfigFileTracker {
 public:
  struct Params {
    /// Files are found only below this folder. Empty: anywhere.
    std::filesystem::path root{};
    /// A file named by a whole path below this one is looked up at the same place below `root`.
    std::filesystem::path once_at{};
  };
  struct File {
    std::filesystem::path path;  ///< absolute
    bool by_whole_path{false};   ///< another file names it by its whole path
  };

  ConfigFileTracker();
  explicit ConfigFileTracker(Params params);
  ~ConfigFileTracker();
  ConfigFileTracker(const ConfigFileTracker&) = delete;
  ConfigFileTracker& operator=(const ConfigFileTracker&) = delete;

  /// Each file once, in the order in which they were first named.
  [[nodiscard]] const std::vector<File>& files() const { return files_; }

  /// For Reader: records a file that is read.
  static void RecordFile(const std::filesystem::path& path, bool by_whole_path = false);
  /// For Reader: the path of a file that another one, in `folder`, names. Empty: not below the root.
  [[nodiscard]] static std::filesystem::path ResolveNamed(const std::filesystem::path& folder,
                                                          const std::filesystem::path& named);

 private:
  Params params_;
  std::vector<File> files_;
};

}  // namespace osteon::config
