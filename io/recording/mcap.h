#pragma once

#include <cstdint>
#include <string_view>

// The part of MCAP that recordings use (https://mcap.dev/spec). A record is an opcode (u8), the content's
// length (u64) and the content, all little-endian. A file consists of
//
//     magic | Header | Chunk, MessageIndex … | DataEnd | Schema …, Channel …, Statistics, ChunkIndex … |
//     Footer | magic
//
// Chunks hold Schema, Channel and Message records, compressed by zstd. The indexes let a standard reader find
// a chunk by time.

namespace osteon::io::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};

enum Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kStatistics = 0x0b,
  kDataEnd = 0x0f,
};

inline constexpr std::size_t kRecordHead = 9;  // bytes of a record before its content: opcode and length

}  // namespace osteon::io::mcap
