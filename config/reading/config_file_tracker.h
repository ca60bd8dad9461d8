#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteon::config {

/// Finds the folder with the shipped cells/, robots/, tools/ …: $OSTEON_ROOT/config; without that variable
/// ./config, or else, nearest above the program, config/ (a build inside the checkout) or
/// share/osteon/config/ (an installation).
/// @param root  $OSTEON_ROOT, or null;  @param program  the running program's file
[[nodiscard]] std::filesystem::path FindShippedFolder(const char* root, const std::filesystem::path& here,
                                                      const std::filesystem::path& program);
/// The folder that FindShippedFolder finds for this process, until SetShippedFolder says another.
[[nodiscard]] std::filesystem::path ShippedFolder();
/// Call before other threads exist.
void SetShippedFolder(const std::filesystem::path& folder);

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
  /// For Reader: the file that another one names by a word alone ("reamer"). It is looked for
  /// in the sibling folder of its kind ("tools"), then in that of the shipped files; below a root, then in
  /// any folder of that name. A cell is looked for beside the other file first.
  /// @param by  the file that names it, which a cell of the same name does not mean
  /// Empty: there is none.
  [[nodiscard]] static std::filesystem::path FindByName(const std::filesystem::path& by,
                                                        const std::string& kind, const std::string& name);

 private:
  Params params_;
  std::vector<File> files_;
};

}  // namespace osteon::config
