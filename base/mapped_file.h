#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include <tl/expected.hpp>

#include "base/file_error.h"

namespace osteon::simulation {

/// A regular file's bytes, mapped read-only. The bytes stay unchanged if somebody replaces the file by a
/// rename, as OutputFile does. If somebody truncates the file in place, reading the bytes ends the process,
/// as with every mapping.
class MappedFile {
 public:
  /// Opens a file without waiting: a pipe or a device is refused without reading from it.
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

/// CRC-32 (zlib's) of a file's bytes: identifies the mesh that a packing was made from.
[[nodiscard]] tl::expected<std::uint32_t, FileError> FileChecksum(const std::filesystem::path& path);

}  // namespace osteon::simulation
