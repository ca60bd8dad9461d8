#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace osteon::config {

/// Finds the folder with the shipped cells/, robots/, tools/ …: $OSTEON_ROOT/config; without that variable
/// ./config, or else, nearest above the program, config/ (a build inside the checkout) or
/// share/osteon/config/ (an installation).
/// @param root  $OSTEON_ROOT, or null;  @param here  the present folder, "."
/// @param program  the running program's file
[[nodiscard]] std::filesystem::path FindShippedFolder(const char* root, const std::filesystem::path& here,
                                                      const std::filesystem::path& program);
/// The folder that FindShippedFolder finds for this process, unless SetShippedFolder has set another.
[[nodiscard]] std::filesystem::path ShippedFolder();
/// Sets the folder that ShippedFolder returns. Call before other threads exist.
void SetShippedFolder(const std::filesystem::path& folder);

/// While an object exists, records the files that this thread reads a configuration from. It may also
/// restrict them to one folder, so that the files in a recording can be read again without any other. A
/// thread may have one object at a time.
class ConfigFileTracker {
 public:
  struct Params {
    /// Files are found only below this folder. Empty: anywhere.
    std::filesystem::path root{};
    /// A file that is named by a whole path below this folder is looked up at the same place below `root`.
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
  /// For Reader: returns the path of a file that a file in `folder` names. Empty if it is not below the root.
  [[nodiscard]] static std::filesystem::path ResolveNamed(const std::filesystem::path& folder,
                                                          const std::filesystem::path& named);
  /// For Reader: finds a file that another one names by a word alone ("reamer"). The first place is the
  /// sibling folder of the file's kind ("tools"), or for a cell the folder of the other file. The second
  /// place is the shipped folder of this kind; with a root, any folder of this name below the root.
  /// @param by  the file that contains the name; a cell that extends one of its own name does not find itself
  /// @returns the file, or an empty path if there is none.
  [[nodiscard]] static std::filesystem::path FindByName(const std::filesystem::path& by,
                                                        const std::string& kind, const std::string& name);

 private:
  Params params_;
  std::vector<File> files_;
};

}  // namespace osteon::config
