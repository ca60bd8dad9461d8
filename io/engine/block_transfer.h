#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "io/engine/byte_cursor.h"
#include "io/engine/codec.h"

// Transfers a block of bytes (a set-up, a carved state) in datagrams. The receiver requests pieces of the
// block, and requests missing pieces again. The sender only answers requests.

namespace osteon::io {

enum class EngineBlock : std::uint8_t { kSetup = 0, kCarved = 1 };

/// Bytes of a block in one message; the last piece may be shorter.
inline constexpr std::size_t kPieceBytes = 1280;
/// Largest number of pieces in one request. Their total size is below that of any system's socket buffers.
inline constexpr std::size_t kWindowPieces = 32;
/// Largest block; a larger one is refused.
inline constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{1} << 30;
/// Time after which missing pieces are requested again.
inline constexpr rt::Nanoseconds kAskAgain = 20 * rt::kMillisecond;

/// A request for `count` pieces of a block, from number `first` on.
struct EngineWant {
  EngineBlock block{EngineBlock::kSetup};
  std::uint64_t first{0};
  std::uint32_t count{0};
};

/// Encodes a request as a complete message. @param header its kind must be kWant
inline EngineBytes EncodeWant(const EngineHeader& header, const EngineWant& want) {
  std::array<std::uint8_t, 13> content;
  ByteWriter writer(content);
  writer.Put(want.block);
  writer.Put(want.first);
  writer.Put(want.count);
  EngineBytes bytes;
  EncodeEngine(header, content, bytes);
  return bytes;
}

/// Decodes a message's content; returns nothing if it is no valid request.
[[nodiscard]] inline std::optional<EngineWant> DecodeWant(std::span<const std::uint8_t> content) {
  ByteReader reader(content);
  EngineWant want;
  reader.Get(want.block);
  reader.Get(want.first);
  reader.Get(want.count);
  if (!reader.ok() || reader.left() > 0 || want.block > EngineBlock::kCarved || want.count > kWindowPieces)
    return std::nullopt;
  return want;
}

/// Calls `send` with the content of each requested piece that exists in `bytes`.
template <class Send>
void AnswerWant(const EngineWant& want, std::span<const std::uint8_t> bytes, Send send) {
  const std::uint64_t pieces = (bytes.size() + kPieceBytes - 1) / kPieceBytes;
  for (std::uint64_t piece = want.first; piece < pieces && piece - want.first < want.count; ++piece) {
    std::array<std::uint8_t, kPieceBytes + 9> content;
    ByteWriter writer(content);
    writer.Put(want.block);
    writer.Put(piece);
    const std::size_t at = piece * kPieceBytes;
    writer.PutBytes(bytes.subspan(at, std::min(kPieceBytes, bytes.size() - at)));
    send(std::span<const std::uint8_t>(content.data(), writer.size()));
  }
}

/// The receiver of a block whose size is known.
class BlockReceiver {
 public:
  /// @param size  at most kMaxBlockBytes
  BlockReceiver(EngineBlock block, std::uint64_t size)
      : block_(block), bytes_(size), has_((size + kPieceBytes - 1) / kPieceBytes, false) {}

  /// Stores the content of a kPiece message. Returns false if it is no piece of this block.
  bool Accept(std::span<const std::uint8_t> content) {
    ByteReader reader(content);
    const auto block = reader.Get<EngineBlock>();
    const auto piece = reader.Get<std::uint64_t>();
    if (!reader.ok() || block != block_ || piece >= has_.size()) return false;
    const std::size_t at = piece * kPieceBytes, size = std::min(kPieceBytes, bytes_.size() - at);
    if (reader.left() != size) return false;
    if (has_[piece]) return true;
    const auto from = reader.GetBytes(size);
    std::ranges::copy(from, bytes_.begin() + static_cast<std::ptrdiff_t>(at));
    has_[piece] = true;
    while (missing_ < has_.size() && has_[missing_]) ++missing_;
    return true;
  }
  [[nodiscard]] bool complete() const { return missing_ == has_.size(); }

  /// Returns the next request for pieces, if the answer to the last request is complete or overdue.
  [[nodiscard]] std::optional<EngineWant> NextWant(rt::Nanoseconds now) {
    if (complete() || (missing_ < asked_to_ && now - asked_at_ < kAskAgain)) return std::nullopt;
    asked_at_ = now;
    asked_to_ = std::min<std::uint64_t>(missing_ + kWindowPieces, has_.size());
    return EngineWant{
        .block = block_, .first = missing_, .count = static_cast<std::uint32_t>(asked_to_ - missing_)};
  }
  /// Moves the block's bytes out. Call once the block is complete.
  [[nodiscard]] std::vector<std::uint8_t> TakeBytes() { return std::move(bytes_); }

 private:
  EngineBlock block_;
  std::vector<std::uint8_t> bytes_;
  std::vector<bool> has_;      // for each piece: whether it was received
  std::uint64_t missing_{0};   // number of the first missing piece
  std::uint64_t asked_to_{0};  // end of the range of pieces requested last
  rt::Nanoseconds asked_at_{0};
};

}  // namespace osteon::io
