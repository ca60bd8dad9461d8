#pragma once

#include <cstdint>
#include <optional>

#include "base/marker.h"
#include "io/can/frame.h"

// The part of CANopen (CiA 301) that a drive's client needs. Numbers are little-endian; a node has the number
// 1 … 127.

namespace osteon::io::canopen {

/// CAN identifiers of CiA 301's predefined connection set. NMT and SYNC have one identifier for all nodes.
/// For the other messages, the node's number is added to the identifier below.
inline constexpr std::uint16_t kNmt = 0x000, kSync = 0x080, kEmergency = 0x080, kTpdo1 = 0x180,
                               kRpdo1 = 0x200, kTpdo2 = 0x280, kSdoAnswer = 0x580, kSdoRequest = 0x600,
                               kHeartbeat = 0x700;

enum class NmtCommand : std::uint8_t { kStart = 0x01, kStop = 0x02, kPreOperational = 0x80, kReset = 0x81 };

/// NMT state of a node, as sent in its heartbeat.
enum class NmtState : std::uint8_t {
  kBootUp = 0x00,
  kStopped = 0x04,
  kOperational = 0x05,
  kPreOperational = 0x7F,
  kUnknown = 0xFF,
};

// These functions return the frames of an NMT command, of SYNC and of a heartbeat.
[[nodiscard]] CanFrame Nmt(NmtCommand command, std::uint8_t node) OSTEON_RT;
[[nodiscard]] CanFrame Sync() OSTEON_RT;
[[nodiscard]] CanFrame Heartbeat(std::uint8_t node, NmtState state) OSTEON_RT;

/// One entry of an object dictionary.
struct Object {
  std::uint16_t index{0};
  std::uint8_t sub{0};
  std::uint8_t size{0};  ///< bytes: 1, 2 or 4

  friend bool operator==(const Object&, const Object&) = default;
};

/// Requests to write or read an object by an expedited transfer: a value of up to 4 bytes in one frame.
[[nodiscard]] CanFrame SdoWrite(std::uint8_t node, const Object& object, std::uint32_t value) OSTEON_RT;
[[nodiscard]] CanFrame SdoRead(std::uint8_t node, const Object& object) OSTEON_RT;

/// The drive's answer to an SDO request.
struct SdoAnswer {
  enum class Kind : std::uint8_t { kWritten, kValue, kAbort };
  Kind kind{Kind::kAbort};
  std::uint16_t index{0};
  std::uint8_t sub{0};
  std::uint8_t size{0};    ///< size of the value [bytes]; 4 if the server does not specify it
  std::uint32_t value{0};  ///< the value, or the abort code
};

/// Decodes an answer; returns nothing if the frame is no answer to an expedited transfer.
[[nodiscard]] std::optional<SdoAnswer> DecodeSdo(const CanFrame& frame) OSTEON_RT;

/// Text of an abort code; not for the tick.
[[nodiscard]] const char* DescribeAbort(std::uint32_t code);

/// Returns the mapping entry that puts an object into a PDO: its index, sub-index and length in bits.
[[nodiscard]] constexpr std::uint32_t Mapped(const Object& object) OSTEON_RT {
  return std::uint32_t{object.index} << 16 | std::uint32_t{object.sub} << 8 | object.size * 8u;
}

}  // namespace osteon::io::canopen
