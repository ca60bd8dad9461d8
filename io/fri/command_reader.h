#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "control/rt/marker.h"
#include "io/fri/version.h"

// A client's answer, read by somebody who stands between client and arm: the guard. It shares no code with
// what writes answers (codec.h) but the frame of 2.7.

namespace osteon::io {

enum class FriCommandError : std::uint8_t {
  kNone = 0,
  kMalformed,  ///< no protobuf, no command, too long, or with anything in it that a command has not, or has
               ///< twice
  kChecksum,   ///< 2.7: the frame's CRC-32 is not the message's
};

/// What an answer commands. Numbers as on the wire: they may be NaN or beyond anything.
struct FriReadCommand {
  std::uint32_t sequence{0}, reflected_sequence{0};
  std::optional<std::array<double, 7>> q{};       ///< [rad]
  std::optional<std::array<double, 6>> wrench{};  ///< force [N], torques [N·m] in the wire's order
  std::optional<std::array<double, 7>> tau{};     ///< [N·m]
  bool cartesian{false};                          ///< a Cartesian pose or a redundancy as well
};

/// Reads a datagram strictly: what a tolerant reader on the arm's side could understand otherwise (a field
/// that comes twice, one that no version has, a count that is another) is refused. `command` changes on kNone
/// only.
[[nodiscard]] FriCommandError ReadCommand(FriFamily family, std::span<const std::uint8_t> datagram,
                                          FriReadCommand& command) OSTEON_RT;

}  // namespace osteon::io
