#pragma once

#include <filesystem>
#include <string>

// A saved bone consists of two files: FILE has the carved state, FILE.swept has the carved surface.

namespace osteon::plugin {

/// Returns the name FILE.swept.
[[nodiscard]] std::filesystem::path SweptFileOf(const std::string& file);

/// @throws Failure if the name is empty, or names something other than a regular file.
void CheckSaveName(const std::filesystem::path& file);

/// The file with a saved bone's surface. It is written under a temporary name, and Commit renames it to
/// FILE.swept. Without Commit the file is removed, and an earlier FILE.swept stays.
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
