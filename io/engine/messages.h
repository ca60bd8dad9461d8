#pragma once

#include <cstddef>
#include <cstdint>

#include "base/clock.h"
#include "simulation/contact/contact_model.h"
#include "simulation/engine/cutting_engine.h"

// Messages between a run and a cutting engine in a process of its own. Plain data.

namespace osteon::io {

inline constexpr std::uint32_t kEngineMagic = 0x4e45534f;  // "OSEN"
inline constexpr std::uint16_t kEngineVersion = 1;
/// The longest message. It fits a datagram that no network splits.
inline constexpr std::size_t kEngineMaxMessage = 1472;

enum class EngineMessage : std::uint16_t {
  kHello = 1,    ///< run to engine: begins a session, with the token
  kWelcome = 2,  ///< engine to run: the session's number, and how far its set-up is
  kCommand = 3,  ///< run to engine: the newest tool pose
  kFrame = 4,    ///< engine to run: the frame made for a tool pose
  kWant = 5,     ///< either way: asks for pieces of a block of bytes
  kPiece = 6,    ///< answer to kWant: one piece
  kEnd = 7,      ///< run to engine: no command follows; the carved state may be asked for
  kGoodbye = 8,  ///< run to engine: the session is over
};

/// The beginning of every message.
struct EngineHeader {
  EngineMessage kind{EngineMessage::kCommand};
  std::uint64_t session{0};   ///< made anew by the engine for each run
  std::uint64_t sequence{0};  ///< counts the sender's messages of this kind
};

/// The pose that the tool reaches at the end of a frame.
struct EngineCommand {
  simulation::ToolCommand command;
  double dt_s{-1.0};  ///< time in which the bone can give way; negative: the time since the command before
};

/// A frame. `model.pose_stamp` returns the command's stamp, so that the run knows the model's age by its own
/// clock.
struct EngineFrame {
  simulation::ContactModel model;
  double spindle_rad_per_s{0.0};   ///< of the command
  rt::Nanoseconds duration_ns{0};  ///< of the frame, by the engine's clock
};

/// Why a message was refused.
enum class EngineError : std::uint8_t {
  kNone,
  kWrongSize,     ///< shorter than its header, longer than accepted, or not as long as it says
  kNotOurs,       ///< does not begin with kEngineMagic
  kOtherVersion,  ///< of the protocol
  kChecksum,
  kWrongKind,
  kOutOfRange,  ///< a number that is not finite, a pose that is no rotation, a count beyond its array
};
[[nodiscard]] const char* Describe(EngineError error);

}  // namespace osteon::io
