#pragma once

#include <unistd.h>

#include <charconv>
#include <string>
#include <string_view>

#include "tests/fuzz/targets/fuzz_input.h"
#include "tests/io/temporary_folder.h"

// Shared parts of the fuzz targets that read files: a file with the fuzzer's bytes, and claims about the
// place that an error names.

namespace osteon::fuzz {

/// A temporary folder, in memory if the system has a file system in memory: then thousands of inputs need no
/// disk.
inline std::filesystem::path FastFolder() {
  const std::filesystem::path memory = "/dev/shm";
  return ::access(memory.c_str(), W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
}

/// A file in a temporary folder of its own. It is rewritten for each input.
class FuzzFile {
 public:
  explicit FuzzFile(const std::string& name) : path_(folder_.path() / name) {}

  void Write(std::string_view bytes) const { io::test::WriteAll(path_, std::string(bytes)); }
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path Beside(const std::string& name) const { return folder_.path() / name; }

 private:
  io::test::TemporaryFolder folder_{FastFolder()};
  std::filesystem::path path_;
};

/// The bytes as a string.
inline std::string Text(std::span<const std::uint8_t> bytes) { return {bytes.begin(), bytes.end()}; }

/// Returns the number that follows `before` in `text`; -1 if there is none.
inline long long NumberBehind(std::string_view text, std::string_view before) {
  const std::size_t at = text.find(before);
  if (at == std::string_view::npos) return -1;
  long long number = -1;
  std::from_chars(text.data() + at + before.size(), text.data() + text.size(), number);
  return number;
}

/// Claims that an error has the form "FILE: byte N: …", where N is an offset in the file or the offset just
/// behind its last byte.
inline void ClaimNamesByte(std::string_view error, const std::filesystem::path& path, std::size_t size) {
  Claim(error.starts_with(path.string() + ": "), "an error names the file");
  const long long byte = NumberBehind(error, path.string() + ": byte ");
  Claim(byte >= 0 && static_cast<unsigned long long>(byte) <= size, "an error names a byte of the file");
}

/// Claims that an error has the form "FILE:N: …", where N is a line of the text or the line just behind its
/// last line.
inline void ClaimNamesLine(std::string_view error, const std::string& name, std::string_view text) {
  const auto is_end = [](char c) {
    return c == '\n' || c == '\r';
  };  // a line of a mesh file may end with CR alone
  const auto lines = static_cast<long long>(std::count_if(text.begin(), text.end(), is_end)) + 1;
  const long long line = NumberBehind(error, name + ":");
  Claim(error.starts_with(name + ":") && line >= 1 && line <= lines + 1, "an error names a line of the file");
}

}  // namespace osteon::fuzz
