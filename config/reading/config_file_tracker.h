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

/// While an object exists, it records the files from which this thread reads a configuration. It can also
/// restrict reading to the files below one folder. The files that a recording contains are read in this way,
/// so that no other file can replace one of them. A thread may have one object at a time.
class ConfigFileTracker {
 public:
  struct Params {
    /// Files are found only below this folder. Empty: anywhere.
    std::filesystem::path root{};
    /// A file that is named by an absolute path below this folder is looked up at the same relative path
    /// below `root`.
    std::filesystem::path once_at{};
  };
  struct File {
    std::filesystem::path path;  ///< absolute
    bool by_whole_path{false};   ///< another file names it by its absolute path
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
  /// For Reader: finds a file that the file `by` names by a word alone ("reamer"). Searches first the folder
  /// of this kind ("tools") beside the folder of `by`; for a cell, the folder of `by` itself. Then searches
  /// the shipped folder of this kind; with a root, any folder of this name below the root.
  /// @param by  the file that contains the name. It is never the result: a cell can extend another cell of
  /// its
  ///   own name.
  /// @returns the file, or an empty path if there is none.
  [[nodiscard]] static std::filesystem::path FindByName(const std::filesystem::path& by,
                                                        const std::string& kind, const std::string& name);

 private:
  Params params_;
  std::vector<File> files_;
};

}  // namespace osteon::config
