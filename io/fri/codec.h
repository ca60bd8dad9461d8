#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/marker.h"
#include "io/fri/messages.h"
#include "io/fri/version.h"

// FRI datagrams to plain structs and back, in the caller's memory, for the client's side. The simulated arm
// (hil) has a codec of its own, over libprotobuf, so that the two check each other. Input is untrusted until
// DecodeMonitoring returns kNone.

namespace osteon::io {

inline constexpr std::size_t kFriMaxDatagram = 1500;
inline constexpr std::uint32_t kFriMonitoringId = 0x245142;
inline constexpr std::uint32_t kFriCommandId = 0x34001;

/// Why a datagram was refused.
enum class CodecError : std::uint8_t {
  kNone = 0,
  kTooLong,       ///< more than 1500 bytes
  kMalformed,     ///< not a protobuf of this message, or an array longer than the wire's fixed size
  kWrongId,       ///< another message identifier in the header
  kMissingField,  ///< without connection info, measured position (beyond IDLE) or ipo position (COMMANDING_*)
  kWrongCount,    ///< wrong number of joint values, drive states, matrix or quaternion elements
  kNotFinite,     ///< NaN or infinity
  kOutOfRange,    ///< an enum, a period, a multiplier or a rotation that does not exist
  kNoSpace,       ///< the caller's buffer is too small, or the message exceeds 1500 bytes
  kChecksum,      ///< 2.7: the frame's CRC-32 does not match the message
  kOtherVersion,  ///< a message of another family of versions: DetectFamily says which
};

/// One line for screens and logs; not for the tick.
[[nodiscard]] const char* Describe(CodecError error);

/// Parses and checks a message from an arm of that family. `message` is changed only on kNone.
[[nodiscard]] CodecError DecodeMonitoring(FriFamily family, std::span<const std::uint8_t> datagram,
                                          MonitoringMessage& message) OSTEON_RT;

/// Whether the datagram can be read as a message from an arm of that family.
[[nodiscard]] bool IsMonitoringMessage(FriFamily family, std::span<const std::uint8_t> datagram) OSTEON_RT;

/// The measured joints [rad] of a message that was refused because one of them is NaN or infinite. Empty if
/// it was refused for another reason.
[[nodiscard]] std::optional<control::JointArray> JointsNotFinite(
    FriFamily family, std::span<const std::uint8_t> datagram) OSTEON_RT;

/// Detects the FRI family of a monitoring message, by its framing and by fields that only one family has.
/// Empty if it is no monitoring message, or has none of these fields (an arm that reports only its session
/// state).
[[nodiscard]] std::optional<FriFamily> DetectFamily(std::span<const std::uint8_t> datagram) OSTEON_RT;

/// Writes a client's answer; `size` is the datagram's length on kNone. Never encodes a value that is not
/// finite. Poses are left out if the family has none.
[[nodiscard]] CodecError EncodeCommand(FriFamily family, const CommandMessage& message,
                                       std::span<std::uint8_t> buffer, std::size_t& size) OSTEON_RT;

}  // namespace osteon::io
