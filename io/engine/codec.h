#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "io/engine/messages.h"

// Format of the messages between run and engine; numbers are little-endian:
//
//     byte  0  magic, 4     "OSEN"
//           4  version, 2
//           6  kind, 2      EngineMessage
//           8  size, 4      of the whole message
//          12  CRC-32, 4    of all bytes except these four
//          16  session, 8
//          24  sequence, 8
//          32  content
//
// A message may be used only after a DecodeEngine function has accepted its length, its checksum and every
// number.

namespace osteon::io {

inline constexpr std::size_t kEngineHeaderBytes = 32;

/// The bytes of a message, and their number.
struct EngineBytes {
  std::array<std::uint8_t, kEngineMaxMessage> bytes;
  std::size_t size{0};
  [[nodiscard]] std::span<const std::uint8_t> view() const OSTEON_RT { return {bytes.data(), size}; }
};

/// Encodes a message from its header and its content. @returns false, with size 0, if the content is too
/// long.
bool EncodeEngine(const EngineHeader& header, std::span<const std::uint8_t> content,
                  EngineBytes& message) OSTEON_RT;
void EncodeEngine(const EngineHeader& header, const EngineCommand& command, EngineBytes& message) OSTEON_RT;
void EncodeEngine(const EngineHeader& header, const EngineFrame& frame, EngineBytes& message) OSTEON_RT;

/// Checks and decodes the header of a message, and its checksum. @param[out] content  points into `message`
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       std::span<const std::uint8_t>& content) OSTEON_RT;
/// Decode a complete message. In case of an error `command` or `frame` is not changed.
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       EngineCommand& command) OSTEON_RT;
[[nodiscard]] EngineError DecodeEngine(std::span<const std::uint8_t> message, EngineHeader& header,
                                       EngineFrame& frame) OSTEON_RT;

}  // namespace osteon::io
