#include "io/recording/mcap_compression.h"

#include <lz4frame.h>
#include <zstd.h>

#include <memory>

namespace osteon::io::mcap {
namespace {

constexpr std::uint64_t kMaxSize = 64u << 20;  // bytes of a chunk's records: a larger chunk is refused
constexpr int kLevel = 3;                      // compression level: libzstd's default

struct FreeContext {
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
};

// Unpacks an lz4 frame into `out`, which has the announced size. Returns the number of bytes unpacked, or the
// error.
tl::expected<std::size_t, std::string> UnpackLz4(std::span<const char> bytes, std::string& out) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION)) != 0)
    return tl::unexpected<std::string>("no memory");
  const std::unique_ptr<LZ4F_dctx, FreeContext> context(made);
  std::size_t read = 0, written = 0;
  for (;;) {
    // before the call: bytes left in the input and in the output; after it: bytes read and bytes written
    std::size_t taken = bytes.size() - read, given = out.size() - written;
    const std::size_t hint =
        LZ4F_decompress(context.get(), out.data() + written, &given, bytes.data() + read, &taken, nullptr);
    if (LZ4F_isError(hint) != 0) return tl::unexpected<std::string>(LZ4F_getErrorName(hint));
    read += taken;
    written += given;
    if (hint == 0 && read == bytes.size()) return written;
    if (taken == 0 && given == 0)
      return tl::unexpected<std::string>(read == bytes.size() ? "it is cut off" : "it holds more than that");
  }
}

// Unpacks a zstd frame in the same way.
tl::expected<std::size_t, std::string> UnpackZstd(std::span<const char> bytes, std::string& out) {
  const std::size_t written = ZSTD_decompress(out.data(), out.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(written) != 0) return tl::unexpected<std::string>(ZSTD_getErrorName(written));
  return written;
}

}  // namespace

tl::expected<std::string, std::string> Decompress(std::string_view compression, std::span<const char> bytes,
                                                  std::uint64_t size) {
  if (compression.empty()) {
    if (size != bytes.size())
      return tl::unexpected("chunk of " + std::to_string(size) + " bytes announced, found " +
                            std::to_string(bytes.size()));
    return std::string(bytes.begin(), bytes.end());
  }
  const bool is_zstd = compression == "zstd";
  if (!is_zstd && compression != "lz4")
    return tl::unexpected("chunk compressed with '" + std::string(compression.substr(0, 30)) +
                          "', accepted: zstd, lz4, or not compressed");
  if (size > kMaxSize)
    return tl::unexpected("chunk of " + std::to_string(size) + " bytes when unpacked, accepted up to " +
                          std::to_string(kMaxSize));
  std::string out(size, '\0');
  const auto written = is_zstd ? UnpackZstd(bytes, out) : UnpackLz4(bytes, out);
  if (!written)
    return tl::unexpected("chunk cannot be unpacked from " + std::string(compression) + " into its " +
                          std::to_string(size) + " bytes: " + written.error());
  if (*written != size)
    return tl::unexpected("chunk unpacks to " + std::to_string(*written) + " bytes, announced are " +
                          std::to_string(size));
  return out;
}

std::string DecompressTorn(std::string_view compression, std::span<const char> bytes, std::uint64_t size) {
  if (compression.empty()) return std::string(bytes.begin(), bytes.end()).substr(0, size);
  if (compression != "zstd" || size > kMaxSize) return {};
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (!context) return {};
  std::string out(size, '\0');
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  ZSTD_outBuffer unpacked{out.data(), out.size(), 0};
  // each call processes as much as it can; the loop ends with a call that neither reads nor writes bytes
  for (std::size_t taken = 0, given = 0;; taken = in.pos, given = unpacked.pos) {
    if (ZSTD_isError(ZSTD_decompressStream(context.get(), &unpacked, &in)) != 0) break;
    if (in.pos == taken && unpacked.pos == given) break;
  }
  out.resize(unpacked.pos);
  return out;
}

void ZstdCompressor::Free::operator()(ZSTD_CCtx_s* context) const { ZSTD_freeCCtx(context); }

ZstdCompressor::ZstdCompressor() : context_(ZSTD_createCCtx()) {}

std::string_view ZstdCompressor::Compress(std::string_view records) {
  if (!context_) return {};
  compressed_.resize(ZSTD_compressBound(records.size()));
  const std::size_t size = ZSTD_compressCCtx(context_.get(), compressed_.data(), compressed_.size(),
                                             records.data(), records.size(), kLevel);
  if (ZSTD_isError(size) != 0 || size >= records.size()) return {};
  return std::string_view(compressed_).substr(0, size);
}

}  // namespace osteon::io::mcap
