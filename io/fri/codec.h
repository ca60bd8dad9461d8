#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/marker.h"
#include "io/fri/messages.h"
#include "io/fri/version.h"

// Converts FRI datagrams to plain structs and back, in the caller's memory, for the client's side. The
// simulated arm (hil) has a separate codec with libprotobuf, so the two check each other. Received data may
// be used only if DecodeMonitoring returns kNone.

namespace osteon::io {

inline constexpr std::size_t kFriMaxDatagram = 1500;
inline constexpr std::uint32_t kFriMonitoringId = 0x245142;
inline constexpr std::uint32_t kFriCommandId = 0x34001;

/// Reason why a datagram was refused.
enum class CodecError : std::uint8_t {
  kNone = 0,
  kTooLong,       ///< more than 1500 bytes
  kMalformed,     ///< no protobuf of this message, or an array that is longer than its fixed size
  kWrongId,       ///< the header has another message identifier
  kMissingField,  ///< connection info, measured position (required beyond IDLE) or interpolator position
                  ///< (COMMANDING states) is missing
  kWrongCount,    ///< wrong number of joint values, drive states, matrix or quaternion elements
  kNotFinite,     ///< a value is NaN or infinite
  kOutOfRange,    ///< an enum, period, multiplier or rotation has an invalid value
  kNoSpace,       ///< the caller's buffer is too small, or the message exceeds 1500 bytes
  kChecksum,      ///< 2.7: the frame's CRC-32 does not match the message
  kOtherVersion,  ///< a message of another family of versions; DetectFamily returns the family
};

/// Returns one line of text for screens and logs. Not for use in the tick.
[[nodiscard]] const char* Describe(CodecError error);

/// Parses and checks a message from an arm of that family. `message` is changed only if the result is kNone.
[[nodiscard]] CodecError DecodeMonitoring(FriFamily family, std::span<const std::uint8_t> datagram,
                                          MonitoringMessage& message) OSTEON_RT;

/// Whether the datagram can be decoded as a message from an arm of that family.
[[nodiscard]] bool IsMonitoringMessage(FriFamily family, std::span<const std::uint8_t> datagram) OSTEON_RT;

/// Returns the measured joints [rad] of a message that DecodeMonitoring refused because one of them is NaN or
/// infinite; empty if it was refused for another reason.
[[nodiscard]] std::optional<control::JointArray> JointsNotFinite(
    FriFamily family, std::span<const std::uint8_t> datagram) OSTEON_RT;

/// Detects the FRI family of a monitoring message, by its framing and by fields that only one family has.
/// Empty if the datagram is no monitoring message, or if it has none of these fields (for example if the arm
/// reports only its session state).
[[nodiscard]] std::optional<FriFamily> DetectFamily(std::span<const std::uint8_t> datagram) OSTEON_RT;

/// Encodes a client's answer; if the result is kNone, `size` is the datagram's length. Refuses values that
/// are not finite. Omits poses if the family has none.
[[nodiscard]] CodecError EncodeCommand(FriFamily family, const CommandMessage& message,
                                       std::span<std::uint8_t> buffer, std::size_t& size) OSTEON_RT;

}  // namespace osteon::io
