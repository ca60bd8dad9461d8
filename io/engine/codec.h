#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "io/engine/messages.h"

// Bytes of the engine's messages, little-endian:
//
//     byte  0  magic, 4     "OSEN"
//           4  version, 2
//           6  kind, 2      EngineMessage
//           8  size, 4      of the whole message
//          12  CRC-32, 4    of all bytes but these four
//          16  session, 8
//          24  sequence, 8
//          32  content
//
// A message is not trusted until a DecodeEngine has accepted its length, its checksum and every number.

namespace osteon::io {

inline constexpr std::size_t kEngineHeaderBytes = 32;

/// A message with its length.
struct EngineBytes {
  std::array<std::uint8_t, kEngineMaxMessage> bytes;
  std::size_t size{0};
  [[nodiscard]] std::span<const std::uint8_t> view() const OSTEON_RT { return {bytes.data(), size}; }
};

/// Encodes a message: a header, then the content. @returns false, with size 0, if the content is too long.
bool EncodeEngine(const EngineHeader& header, std::span<const std::uint8_t> content,
                  EngineBytes& message) OSTEON_RT;
void EncodeEngine(const EngineHeader& header, const EngineCommand& command, EngineBytes& message) OSTEON_RT;
void EncodeEngine(const EngineHeader& header, const EngineFrame& frame, EngineBytes& message) OSTEON_RT;

/// Checks and decodes the header of a message, and its checksum. @param[out] content  points into `message`
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       std::span<const std::uint8_t>& content) OSTEON_RT;
/// Decodes a whole message. An error leaves `command` or `frame` unchanged.
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       EngineCommand& command) OSTEON_RT;
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       EngineFrame& frame) OSTEON_RT;

}  // namespace osteon::io
