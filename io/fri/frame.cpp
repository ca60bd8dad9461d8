#include "io/fri/frame.h"

#include <zlib.h>

namespace osteon::io {
namespace {

std::uint32_t ReadLittleEndian(std::span<const std::uint8_t, 4> bytes) OSTEON_RT {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | bytes[i];
  return value;
}

void WriteLittleEndian(std::uint32_t value, std::span<std::uint8_t, 4> bytes) OSTEON_RT {
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(value);
    value >>= 8;
  }
}

// CRC-32 of the protobuf.
std::uint32_t Checksum(std::span<const std::uint8_t> body) OSTEON_RT {
  return static_cast<std::uint32_t>(crc32_z(0, body.data(), body.size()));
}

}  // namespace

FrameError Unframe(std::span<const std::uint8_t> datagram, std::span<const std::uint8_t>& body) OSTEON_RT {
  constexpr std::size_t frame_bytes = kFriFrameHead + kFriFrameTail;
  if (datagram.size() < frame_bytes ||
      ReadLittleEndian(datagram.first<kFriFrameHead>()) != datagram.size() - frame_bytes)
    return FrameError::kNotFramed;
  const auto inside = datagram.subspan(kFriFrameHead, datagram.size() - frame_bytes);
  if (ReadLittleEndian(datagram.last<kFriFrameTail>()) != Checksum(inside)) return FrameError::kChecksum;
  body = inside;
  return FrameError::kNone;
}

std::size_t Frame(std::span<std::uint8_t> buffer, std::size_t size) OSTEON_RT {
  WriteLittleEndian(static_cast<std::uint32_t>(size), buffer.first<kFriFrameHead>());
  const std::span<std::uint8_t> tail = buffer.subspan(kFriFrameHead + size, kFriFrameTail);
  WriteLittleEndian(Checksum(buffer.subspan(kFriFrameHead, size)), tail.first<kFriFrameTail>());
  return kFriFrameHead + size + kFriFrameTail;
}

}  // namespace osteon::io
