#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"

// The frame that FRI 2.7 puts around each message:
//
//     u32 length, little-endian | protobuf, `length` bytes | u32 CRC-32 of the protobuf, little-endian
//
// The CRC is that of zlib (polynomial 0x04C11DB7, reflected). A message without a frame cannot be mistaken
// for a framed one: it begins with bytes such as 0a 08, which would be a length of some 100 MB.

namespace osteon::io {

inline constexpr std::size_t kFriFrameHead = 4, kFriFrameTail = 4;  ///< bytes of length and CRC-32

enum class FrameError : std::uint8_t {
  kNone = 0,
  kNotFramed,  ///< the length does not match the datagram
  kChecksum,   ///< the length matches, but the CRC does not
};

/// Checks the frame and finds the protobuf inside. `body` is changed only if the result is kNone.
[[nodiscard]] FrameError Unframe(std::span<const std::uint8_t> datagram,
                                 std::span<const std::uint8_t>& body) OSTEON_RT;

/// Puts the frame around a protobuf of `size` bytes at buffer[kFriFrameHead]; the buffer must have room for
/// the tail. @returns the datagram's size.
std::size_t Frame(std::span<std::uint8_t> buffer, std::size_t size) OSTEON_RT;

}  // namespace osteon::io
