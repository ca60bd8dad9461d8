#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "base/marker.h"
#include "io/fri/version.h"

// Decodes a client's answer in the guard, which is a process between client and arm. It shares no code with
// the encoder of answers (codec.h), except for the frame of FRI 2.7.

namespace osteon::io {

enum class FriCommandError : std::uint8_t {
  kNone = 0,
  kMalformed,  ///< no protobuf, no command, too long, or containing an unknown or repeated field
  kChecksum,   ///< 2.7: the frame's CRC-32 does not match the message
};

/// Content of an answer. The numbers are unchecked: they may be NaN or out of range.
struct FriReadCommand {
  std::uint32_t sequence{0}, reflected_sequence{0};
  std::optional<std::array<double, 7>> q{};       ///< [rad]
  std::optional<std::array<double, 6>> wrench{};  ///< force [N], torques [N·m], in the wire's order
  std::optional<std::array<double, 7>> tau{};     ///< [N·m]
  bool cartesian{false};  ///< the answer also contains a Cartesian pose or a redundancy
};

/// Decodes a datagram strictly. Refuses everything that a tolerant decoder on the arm's side could interpret
/// differently: a repeated field, a field that no version has, a wrong number of values. `command` is changed
/// only if the result is kNone.
[[nodiscard]] FriCommandError ReadCommand(FriFamily family, std::span<const std::uint8_t> datagram,
                                          FriReadCommand& command) OSTEON_RT;

}  // namespace osteon::io
