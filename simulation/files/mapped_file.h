#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include <tl/expected.hpp>

#include "simulation/files/file_error.h"

namespace osteon::simulation {

/// A regular file's bytes, mapped read-only. The bytes stay as they are while somebody replaces the file
/// (rename), as OutputFile does; a file that is cut short in place under a reader ends the process, as with
/// every mapping.
class MappedFile {
 public:
  /// Never waits: a pipe or a device is refused, not opened and read.
  [[nodiscard]] static tl::expected<MappedFile, FileError> Open(const std::filesystem::path& path);

  MappedFile() = default;
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
  MappedFile& operator=(MappedFile&& other) noexcept {
    std::swap(bytes_, other.bytes_);
    return *this;
  }

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  std::span<const std::byte> bytes_;
};

/// CRC-32 (zlib's) of a file's bytes: says which mesh a packing was made from.
[[nodiscard]] tl::expected<std::uint32_t, FileError> FileChecksum(const std::filesystem::path& path);

}  // namespace osteon::simulation
