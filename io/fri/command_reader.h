#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/marker.h"
#include "io/fri/version.h"

// Reads a client's answer in the guard, which stands between client and arm. Shares no code with the writer
// of answers (codec.h) except the frame of 2.7.

namespace osteon::io {

enum class FriCommandError : std::uint8_t {
  kNone = 0,
  kMalformed,  ///< no protobuf, no command, too long, or with a field that is unknown or repeated
  kChecksum,   ///< 2.7: the frame's CRC-32 does not match the message
};

/// Content of an answer. Numbers as on the wire: they may be NaN or out of any range.
struct FriReadCommand {
  std::uint32_t sequence{0}, reflected_sequence{0};
  std::optional<std::array<double, 7>> q{};       ///< [rad]
  std::optional<std::array<double, 6>> wrench{};  ///< force [N], torques [N·m] in the wire's order
  std::optional<std::array<double, 7>> tau{};     ///< [N·m]
  bool cartesian{false};                          ///< contains a Cartesian pose or a redundancy, too
};

/// Reads a datagram strictly: anything that a tolerant reader on the arm's side could understand differently
/// (a repeated field, a field of no version, a wrong count) is refused. `command` is changed only on kNone.
[[nodiscard]] FriCommandError ReadCommand(FriFamily family, std::span<const std::uint8_t> datagram,
                                          FriReadCommand& command) OSTEON_RT;

}  // namespace osteon::io
