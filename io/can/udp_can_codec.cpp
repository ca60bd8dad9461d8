#include "io/can/udp_can_codec.h"

#include <algorithm>

#include "io/can/byte_order.h"

namespace osteon::io {

const char* Describe(UdpCanError error) {
  switch (error) {
    case UdpCanError::kNone:
      return "no error";
    case UdpCanError::kTooShort:
      return "shorter than a header of 16 bytes";
    case UdpCanError::kMagic:
      return "does not begin with 'OCAN'";
    case UdpCanError::kVersion:
      return "another version than 1";
    case UdpCanError::kLength:
      return "not the header's number of data bytes, or more than 8";
    case UdpCanError::kId:
      return "identifier beyond 0x7FF";
  }
  return "unknown error";
}

UdpCanError DecodeUdpCan(std::span<const std::uint8_t> datagram, UdpCanMessage& message) OSTEON_RT {
  if (datagram.size() < kUdpCanHeader) return UdpCanError::kTooShort;
  const std::uint8_t* bytes = datagram.data();
  if (GetBig<std::uint32_t>(bytes) != kUdpCanMagic) return UdpCanError::kMagic;
  if (bytes[4] != kUdpCanVersion) return UdpCanError::kVersion;
  const std::uint8_t length = bytes[5];
  if (length > 8 || datagram.size() != kUdpCanHeader + length) return UdpCanError::kLength;
  const auto id = GetBig<std::uint16_t>(bytes + 6);
  if (id > kCanMaxId) return UdpCanError::kId;
  message = {.frame = {.id = id, .size = length},
             .session = GetBig<std::uint32_t>(bytes + 8),
             .sequence = GetBig<std::uint32_t>(bytes + 12)};
  std::copy_n(bytes + kUdpCanHeader, length, message.frame.data.begin());
  return UdpCanError::kNone;
}

std::size_t EncodeUdpCan(const UdpCanMessage& message,
                         std::array<std::uint8_t, kUdpCanMaxDatagram>& buffer) OSTEON_RT {
  const CanFrame& frame = message.frame;
  if (frame.id > kCanMaxId || frame.size > frame.data.size()) return 0;
  PutBig(kUdpCanMagic, buffer.data());
  buffer[4] = kUdpCanVersion;
  buffer[5] = frame.size;
  PutBig(frame.id, buffer.data() + 6);
  PutBig(message.session, buffer.data() + 8);
  PutBig(message.sequence, buffer.data() + 12);
  std::copy_n(frame.data.begin(), frame.size, buffer.begin() + kUdpCanHeader);
  return kUdpCanHeader + frame.size;
}

}  // namespace osteon::io
