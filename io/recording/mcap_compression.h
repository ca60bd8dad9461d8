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
/// @param compression  as the chunk names it: "zstd", "lz4" (its frame format), or "" for none
/// @param size  of the records, as the chunk announces it; no more is allocated
/// @returns them, or what was found and what is accepted.
[[nodiscard]] tl::expected<std::string, std::string> Decompress(std::string_view compression,
                                                                std::span<const char> bytes,
                                                                std::uint64_t size);

/// What there is of the records of a chunk that is cut off: of one that is compressed by zstd its complete
/// blocks (128 KiB of records each), of one by lz4 nothing.
[[nodiscard]] std::string DecompressTorn(std::string_view compression, std::span<const char> bytes,
                                         std::uint64_t size);

/// Compresses one chunk after the other. Equal chunks give equal bytes, with one version of libzstd.
class ZstdCompressor {
 public:
  ZstdCompressor();

  /// @returns a zstd frame, until the next call; empty where it would be no smaller.
  [[nodiscard]] std::string_view Compress(std::string_view records);

 private:
  struct Free {
    void operator()(ZSTD_CCtx_s* context) const;
  };
  std::unique_ptr<ZSTD_CCtx_s, Free> context_;
  std::string compressed_;
};

}  // namespace osteon::io::mcap
