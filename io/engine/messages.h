#pragma once

#include <cstddef>
#include <cstdint>

#include "base/clock.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

// Messages between a run and a cutting engine in a separate process. Plain data.

namespace osteon::io {

inline constexpr std::uint32_t kEngineMagic = 0x4e45534f;  // "OSEN"
inline constexpr std::uint16_t kEngineVersion = 1;
/// Largest size of a message. It fits in a UDP datagram that networks do not fragment.
inline constexpr std::size_t kEngineMaxMessage = 1472;

enum class EngineMessage : std::uint16_t {
  kHello = 1,    ///< run to engine: begins a session, with the token
  kWelcome = 2,  ///< engine to run: the session's number, and the engine's progress (EngineProgress)
  kCommand = 3,  ///< run to engine: the newest tool pose
  kFrame = 4,    ///< engine to run: the frame made for a tool pose
  kWant = 5,     ///< in both directions: requests pieces of a block of bytes
  kPiece = 6,    ///< answer to kWant: one piece
  kEnd = 7,      ///< run to engine: no command follows; the run may then request the carved state
  kGoodbye = 8,  ///< run to engine: the session is over
};

/// The header of every message.
struct EngineHeader {
  EngineMessage kind{EngineMessage::kCommand};
  std::uint64_t session{0};   ///< number that the engine chooses for each run
  std::uint64_t sequence{0};  ///< number of the message among the sender's messages of this kind
};

/// The pose that the tool reaches at the end of a frame.
struct EngineCommand {
  simulation::ToolCommand command;
  /// Time over which the tool cuts in the frame; negative: the time since the previous command.
  double dt_s{-1.0};
};

/// The result of a frame. `model.pose_stamp` is the command's stamp, so the run can compute the model's age
/// with its own clock.
struct EngineFrame {
  simulation::ContactModel model;
  double spindle_rad_per_s{0.0};   ///< spindle speed in the command
  rt::Nanoseconds duration_ns{0};  ///< duration of the frame's computation, by the engine's clock
};

/// Reason why a message was refused.
enum class EngineError : std::uint8_t {
  kNone,
  kWrongSize,  ///< shorter than a header, longer than accepted, or not of the length that its header states
  kNotOurs,    ///< does not begin with kEngineMagic
  kOtherVersion,  ///< another version of the protocol
  kChecksum,
  kWrongKind,
  kOutOfRange,  ///< a number that is not finite, a pose that is no rotation, a count beyond its array
};
[[nodiscard]] const char* Describe(EngineError error);

}  // namespace osteon::io
