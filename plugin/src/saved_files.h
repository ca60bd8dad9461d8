#pragma once

#include <filesystem>
#include <string>

// The two files of a saved bone: FILE, the carved bone, and FILE.swept, its surface.

namespace osteon::plugin {

/// FILE.swept.
[[nodiscard]] std::filesystem::path SweptFileOf(const std::string& file);

/// @throws Failure where something that is no regular file has this name, or it is empty.
void CheckSaveName(const std::filesystem::path& file);

/// The surface of a saved bone under a name of its own, until Commit; then FILE.swept. Without Commit it is
/// removed, and an earlier FILE.swept stays.
class SweptPart {
 public:
  explicit SweptPart(const std::string& saved);
  ~SweptPart();
  SweptPart(const SweptPart&) = delete;
  SweptPart& operator=(const SweptPart&) = delete;

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  /// @throws Failure where the system refuses.
  void Commit() const;

 private:
  std::filesystem::path file_, swept_;
};

}  // namespace osteon::plugin
