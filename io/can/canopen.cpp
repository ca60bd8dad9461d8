#include "io/can/canopen.h"

#include "io/can/byte_order.h"

namespace osteon::io::canopen {
namespace {

// CAN identifier (COB-ID) of a node's message, given the base identifier of the kind of message.
std::uint16_t CobId(std::uint16_t base, std::uint8_t node) OSTEON_RT {
  return static_cast<std::uint16_t>(base + node);
}

}  // namespace

CanFrame Nmt(NmtCommand command, std::uint8_t node) OSTEON_RT {
  return {.id = kNmt, .size = 2, .data = {static_cast<std::uint8_t>(command), node}};
}

CanFrame Sync() OSTEON_RT { return {.id = kSync, .size = 0}; }

CanFrame Heartbeat(std::uint8_t node, NmtState state) OSTEON_RT {
  return {.id = CobId(kHeartbeat, node), .size = 1, .data = {static_cast<std::uint8_t>(state)}};
}

CanFrame SdoWrite(std::uint8_t node, const Object& object, std::uint32_t value) OSTEON_RT {
  CanFrame frame{.id = CobId(kSdoRequest, node), .size = 8};
  // expedited download; bits 2 and 3 are the number of unused bytes of the value
  frame.data[0] = static_cast<std::uint8_t>(0x23 | (4 - object.size) << 2);
  PutLittle(object.index, &frame.data[1]);
  frame.data[3] = object.sub;
  PutLittle(value, &frame.data[4]);
  for (std::size_t i = 4u + object.size; i < 8; ++i) frame.data[i] = 0;
  return frame;
}

CanFrame SdoRead(std::uint8_t node, const Object& object) OSTEON_RT {
  CanFrame frame{.id = CobId(kSdoRequest, node), .size = 8, .data = {0x40}};
  PutLittle(object.index, &frame.data[1]);
  frame.data[3] = object.sub;
  return frame;
}

std::optional<SdoAnswer> DecodeSdo(const CanFrame& frame) OSTEON_RT {
  if (frame.size != 8) return std::nullopt;
  const std::uint8_t command = frame.data[0];
  SdoAnswer answer{.index = GetLittle<std::uint16_t>(&frame.data[1]), .sub = frame.data[3]};
  const auto data = GetLittle<std::uint32_t>(&frame.data[4]);
  if (command == 0x60) {  // write confirmed
    answer.kind = SdoAnswer::Kind::kWritten;
  } else if (command == 0x80) {  // abort: the answer's default kind
    answer.value = data;
  } else if ((command & 0xE2) == 0x42) {  // expedited upload: the value is in this frame
    answer.kind = SdoAnswer::Kind::kValue;
    // if bit 0 is set, bits 2 and 3 are the number of unused bytes
    answer.size = (command & 0x01) != 0 ? static_cast<std::uint8_t>(4 - (command >> 2 & 3)) : std::uint8_t{4};
    answer.value = answer.size == 4 ? data : data & ((1u << 8 * answer.size) - 1);
  } else {
    return std::nullopt;
  }
  return answer;
}

const char* DescribeAbort(std::uint32_t code) {
  switch (code) {
    case 0x05030000:
      return "toggle bit not alternated";
    case 0x05040000:
      return "the drive timed out";
    case 0x05040001:
      return "command not known";
    case 0x06010000:
      return "access not supported";
    case 0x06010001:
      return "write only";
    case 0x06010002:
      return "read only";
    case 0x06020000:
      return "no such object";
    case 0x06040041:
      return "the object cannot be mapped to a PDO";
    case 0x06040042:
      return "the PDO would be too long";
    case 0x06070010:
      return "length does not match";
    case 0x06090011:
      return "no such sub-index";
    case 0x06090030:
      return "value out of range";
    case 0x08000020:
      return "cannot be stored";
    case 0x08000022:
      return "not in this state of the drive";
    default:
      return "a code of the drive's manufacturer, or a rare one of CiA 301";
  }
}

}  // namespace osteon::io::canopen
