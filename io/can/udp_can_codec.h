#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/marker.h"
#include "io/can/frame.h"

// Format of the UDP tunnel's datagrams. Each contains one CAN frame. The format is defined by this project;
// numbers are big-endian.
//
//     byte  0  u32  magic "OCAN"
//           4  u8   version, 1
//           5  u8   length of the data, 0 … 8
//           6  u16  identifier, 0 … 0x7FF
//           8  u32  session: a new number each time that the sender opens the tunnel
//          12  u32  sequence: number of the frame in the sender's session, from 0, modulo 2^32
//          16       the data: exactly `length` bytes to the end of the datagram

namespace osteon::io {

inline constexpr std::size_t kUdpCanHeader = 16;  ///< number of bytes before the data
inline constexpr std::size_t kUdpCanMaxDatagram = kUdpCanHeader + 8;
inline constexpr std::uint32_t kUdpCanMagic = 0x4F43414E;
inline constexpr std::uint8_t kUdpCanVersion = 1;

struct UdpCanMessage {
  CanFrame frame;
  std::uint32_t session{0};
  std::uint32_t sequence{0};
};

/// Reason why a datagram was refused.
enum class UdpCanError : std::uint8_t {
  kNone = 0,
  kTooShort,  ///< shorter than a header
  kMagic,
  kVersion,
  kLength,  ///< more than 8 data bytes, or not the number that the header contains
  kId,      ///< beyond 11 bits
};

/// Returns one line of text for screens and logs. Not for use in the tick.
[[nodiscard]] const char* Describe(UdpCanError error);

/// Decodes a datagram. `message` is changed only if the result is kNone.
[[nodiscard]] UdpCanError DecodeUdpCan(std::span<const std::uint8_t> datagram,
                                       UdpCanMessage& message) OSTEON_RT;

/// Encodes a message into `buffer`. @returns the datagram's length; 0 if the frame is not a classical CAN
/// frame
[[nodiscard]] std::size_t EncodeUdpCan(const UdpCanMessage& message,
                                       std::array<std::uint8_t, kUdpCanMaxDatagram>& buffer) OSTEON_RT;

}  // namespace osteon::io
