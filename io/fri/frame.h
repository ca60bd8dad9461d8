#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"

// FRI 2.7's frame around each message:
//
//     u32 length, little-endian | protobuf, `length` bytes | u32 CRC-32 of the protobuf, little-endian
//
// The CRC is zlib's (polynomial 0x04C11DB7, reflected). Bare messages cannot be mistaken for framed ones:
// they begin with 0a 08 or the like, which as a length would be some 100 MB.

namespace osteon::io {

inline constexpr std::size_t kFriFrameHead = 4, kFriFrameTail = 4;  ///< bytes of length and CRC-32

enum class FrameError : std::uint8_t {
  kNone = 0,
  kNotFramed,  ///< the length does not match the datagram
  kChecksum,   ///< the length matches, but the CRC does not
};

/// Checks the frame and finds the protobuf inside. `body` is changed only on kNone.
[[nodiscard]] FrameError Unframe(std::span<const std::uint8_t> datagram,
                                 std::span<const std::uint8_t>& body) OSTEON_RT;

/// Puts the frame around a protobuf of `size` bytes at buffer[kFriFrameHead]; the buffer has room for the
/// tail. @returns the datagram's size.
std::size_t Frame(std::span<std::uint8_t> buffer, std::size_t size) OSTEON_RT;

}  // namespace osteon::io
