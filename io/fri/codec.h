#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "control/rt/marker.h"
#include "io/fri/messages.h"

// FRI 1.15 datagrams to plain structs and back, by nanopb in fixed memory: what a client reads and writes.
// The simulated arm (hil) has a codec of its own, over libprotobuf, so that the two check each other. What
// comes in is hostile until DecodeMonitoring has said kNone.

namespace osteon::io {

inline constexpr std::size_t kFriMaxDatagram = 1500;
inline constexpr std::uint32_t kFriMonitoringId = 0x245142;
inline constexpr std::uint32_t kFriCommandId = 0x34001;

/// Why a datagram was refused.
enum class CodecError : std::uint8_t {
  kNone = 0,
  kTooLong,       ///< more than 1500 bytes
  kMalformed,     ///< not a protobuf of this message, or an array longer than the wire's fixed size
  kWrongId,       ///< the header's message identifier is another one
  kMissingField,  ///< without connection info, measured position (beyond IDLE) or ipo position (COMMANDING_*)
  kWrongCount,    ///< not exactly seven joint values or drive states, or an arm of another number of joints
  kNotFinite,     ///< NaN or infinity
  kOutOfRange,    ///< an enum, a period or a multiplier that does not exist
  kNoSpace,       ///< the caller's buffer is too small
};

/// One line for screens and logs; not for the tick.
[[nodiscard]] const char* Describe(CodecError error);

/// Parses and checks a message from the arm. `message` changes on kNone only.
[[nodiscard]] CodecError DecodeMonitoring(std::span<const std::uint8_t> datagram,
                                          MonitoringMessage& message) OSTEON_RT;

/// Writes a client's answer; `size` is the datagram's length on kNone. Never encodes a value that is not
/// finite.
[[nodiscard]] CodecError EncodeCommand(const CommandMessage& message, std::span<std::uint8_t> buffer,
                                       std::size_t& size) OSTEON_RT;

}  // namespace osteon::io
