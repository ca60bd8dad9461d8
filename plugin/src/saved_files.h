#pragma once

#include <filesystem>
#include <string>

// The two files of a saved bone: FILE, the carved bone, and FILE.swept, its surface.

namespace osteon::plugin {

/// Returns the name FILE.swept.
[[nodiscard]] std::filesystem::path SweptFileOf(const std::string& file);

/// @throws Failure if the name is empty, or is that of something other than a regular file.
void CheckSaveName(const std::filesystem::path& file);

/// The file for the surface of a saved bone. It has a temporary name until Commit renames it to FILE.swept.
/// Without Commit it is removed, and an earlier FILE.swept stays.
class SweptPart {
 public:
  explicit SweptPart(const std::string& saved);
  ~SweptPart();
  SweptPart(const SweptPart&) = delete;
  SweptPart& operator=(const SweptPart&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// @throws Failure if the system cannot rename the file.
  void Commit() const;

 private:
  std::filesystem::path file_, swept_;
};

}  // namespace osteon::plugin
