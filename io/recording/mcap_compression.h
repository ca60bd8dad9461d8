#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <tl/expected.hpp>

struct ZSTD_CCtx_s;  // ZSTD_CCtx

namespace osteon::io::mcap {

/// Unpacks a chunk's records.
/// @param compression  name in the chunk: "zstd", "lz4" (its frame format), or "" for none
/// @param size of the unpacked records, announced by the chunk; no more is allocated
/// @returns the records, or an error that names the value found and the values accepted.
[[nodiscard]] tl::expected<std::string, std::string> Decompress(std::string_view compression,
                                                                std::span<const char> bytes,
                                                                std::uint64_t size);

/// Returns the records of a truncated chunk that can be recovered: all present bytes if it is not compressed,
/// with zstd its complete blocks (128 KiB of records each), with lz4 nothing.
[[nodiscard]] std::string DecompressTorn(std::string_view compression, std::span<const char> bytes,
                                         std::uint64_t size);

/// Compresses one chunk after the other. Equal chunks give equal bytes, with one version of libzstd.
class ZstdCompressor {
 public:
  ZstdCompressor();

  /// @returns a zstd frame, valid until the next call; empty if the compressed records would not be smaller.
  [[nodiscard]] std::string_view Compress(std::string_view records);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
  std::string compressed_;
};

}  // namespace osteon::io::mcap
