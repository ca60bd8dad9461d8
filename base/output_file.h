#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

#include "base/file_error.h"

namespace osteon::simulation {

/// A file that appears whole or not at all. Bytes go to a temporary file in the same folder. Commit renames
/// this file to the final name; the permissions of an existing file are kept. A device or a pipe is written
/// directly. A symbolic link stays a link: its target is written, even if the target does not exist yet.
///
///     auto file = OutputFile::Create("bone.osp");
///     file->Write(bytes);           // errors are kept until Commit
///     return file->Commit();
class OutputFile {
 public:
  /// Opens the temporary file. The error says why it cannot be written.
  [[nodiscard]] static tl::expected<OutputFile, FileError> Create(const std::filesystem::path& path);

  /// Without Commit, deletes the temporary file; an earlier file of the final name stays.
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  /// Appends bytes; after a failure does nothing.
  void Write(std::span<const std::byte> bytes);
  void Write(std::string_view text) { Write(std::as_bytes(std::span(text))); }

  /// Flushes the bytes to the disk and gives the file its name.
  /// @returns the first error of any step: disk full, no permission.
  [[nodiscard]] tl::expected<void, FileError> Commit();

 private:
  OutputFile(std::filesystem::path path, std::filesystem::path temporary, int fd)
      : path_(std::move(path)), temporary_(std::move(temporary)), fd_(fd) {}
  void Close();

  std::filesystem::path path_, temporary_;  ///< temporary_ is empty if the file is written in place
  int fd_{-1};
  int error_{0};  ///< errno of the first failure
  std::uint64_t written_{0};
};

}  // namespace osteon::simulation
