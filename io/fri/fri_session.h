#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "control/ports.h"
#include "io/fri/codec.h"

namespace osteon::io {

/// What became of a datagram.
enum class FriAccept : std::uint8_t {
  kAccepted,   ///< newer than all before: the state is its content. Or a joint was measured as NaN or
               ///< infinite: the state has the joints, nothing else of it counts, and it is not answered
  kDuplicate,  ///< seen before
  kReordered,  ///< overtaken by a newer one
  kRejected,   ///< not a valid message; last_error() says why
};

/// Which torque comes first in a Cartesian wrench on the wire.
enum class FriTorqueOrder : std::uint8_t {
  kZyx,  ///< about z, y, x: KUKA's A, B, C
  kXyz,
};

struct FriSessionParams {
  FriVersion version{FriVersion::k1_15};
  FriTorqueOrder torque_order{FriTorqueOrder::kZyx};  ///< not confirmed on an arm
  /// The first command of an activation is followed where no joint is further from the interpolator's
  /// position than this; > 0.
  double entry_step_rad{0.02};
};

/// Why an output could not be taken.
enum class FriOutputError : std::uint8_t {
  kNone = 0,
  kUnknown,    ///< the robot program registered none of that name
  kNotOutput,  ///< it is an input
  kWrongType,  ///< boolean, digital or analog, and the value for it
  kFull,       ///< more than a message can carry
};

/// The client's side of an FRI session, all of it but the socket: wall time drives it through FriLink,
/// virtual time through memory.
///
/// **Counters** are compared modulo 2^32. A gap counts as lost until the missing message comes after all; the
/// last 64 counters are remembered to tell reordered ones from duplicates. A counter further back than that
/// belongs to a new session of the arm, and is believed where the message says MONITORING or IDLE: sessions
/// begin there. The other way round, the counter that the arm reflects tells which of our answers it took.
///
/// **What the client owes**, in answer to every receiveMultiplier-th message:
///
///     IDLE                nothing
///     MONITORING_*        1.x: the arm's commanded position, mirrored; 2.x: the header alone
///     COMMANDING_WAIT     the arm's interpolator position, mirrored; with it a zero wrench or torque in
///     WRENCH
///                         or TORQUE mode, whose absence would end the session
///     COMMANDING_ACTIVE   the loop's position, and its wrench or torque
///
/// **No jump on coming back.** Each time that COMMANDING_ACTIVE begins (or a gap of 64 messages might have
/// hidden it) the interpolator's position is held, without wrench or torque, until a command names this
/// activation and starts near that position. A command that is not finite is never sent: the last position is
/// held. Where the arm asks for Cartesian poses, its own is mirrored.
///
/// Allocation-free but where said otherwise; one thread at a time.
class FriSession {
 public:
  explicit FriSession(const FriSessionParams& params = {}) OSTEON_RT : params_(params),
                                                                       family_(FamilyOf(params.version)) {}

  /// Takes a datagram that arrived at `stamp`. The counters of `state` are always set, the rest on kAccepted
  /// only.
  FriAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// It can be read as a message of the arm; nothing is changed by looking.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// The datagram that answers the message last accepted; empty where none is owed (yet), or it was answered
  /// before. Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// Sets an output of the robot's field buses, if the last message listed it. Goes along with the answers
  /// until the arm has taken one of them.
  FriOutputError Write(const FriIo& output) OSTEON_RT;

  /// Moves a frame that the last message asked for. Goes along with each answer to a message that asks for
  /// it.
  FriOutputError Transform(const FriTransformation& transformation) OSTEON_RT;

  /// The message accepted before the last was never looked at: a newer one was already waiting behind it.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// A datagram was refused before it came here, e.g. for its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// The next message begins a session, whatever its counter; the counts of ArmState go on.
  void StartOver() OSTEON_RT;

  /// Why the last kRejected datagram was refused.
  [[nodiscard]] CodecError last_error() const OSTEON_RT { return last_error_; }
  /// The message last accepted: robot info, inputs and outputs, what ArmState has no room for. As constructed
  /// before the first.
  [[nodiscard]] const MonitoringMessage& message() const OSTEON_RT { return last_; }
  /// The arm's estimate of the external force at its motion centre, where it sends one (2.7).
  [[nodiscard]] std::optional<PlainWrench> external_force() const OSTEON_RT;
  /// What the arm speaks, where it was refused for speaking another version than configured.
  [[nodiscard]] std::optional<FriFamily> other_family() const OSTEON_RT { return other_family_; }

  /// What keeps the arm from being commanded, in one or a few sentences; empty where nothing does. For
  /// screens and logs: allocates.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  FriAccept CheckSequence(const MonitoringMessage& message) OSTEON_RT;
  void CheckReflected(const MonitoringMessage& message) OSTEON_RT;
  void CheckActivation(const MonitoringMessage& message) OSTEON_RT;
  void BeginSession() OSTEON_RT;
  [[nodiscard]] bool Follows(const control::ArmCommand& command) OSTEON_RT;
  void PutMotion(const control::ArmCommand& command, CommandMessage& answer) OSTEON_RT;
  void PutOutputs(FriOutputs& outputs) OSTEON_RT;
  void PutCounters(control::ArmState& state) const OSTEON_RT;

  struct Counters {
    std::uint32_t lost{0}, duplicate{0}, late{0}, reordered{0}, rejected{0}, other_version{0};
    std::uint32_t answers_lost{0}, answers_foreign{0};
  };

  FriSessionParams params_;
  FriFamily family_;
  MonitoringMessage last_;
  control::SessionState session_before_{control::SessionState::kIdle};  // before the one of last_
  bool has_last_{false};
  std::uint64_t seen_{0};  // bit i: counter last_.sequence - i has arrived
  std::uint32_t due_{0};   // messages of the arm since our last answer, lost ones included
  bool pending_{false};    // last_ is not answered yet
  Counters counters_;
  CodecError last_error_{CodecError::kNone};
  std::optional<FriFamily> other_family_;

  // our answers
  std::uint32_t command_sequence_{1};  // of the next; an arm that has seen none reflects 0
  std::uint32_t first_answer_{1};      // of this session
  std::uint32_t reflected_{0};         // the newest of ours that the arm has seen
  bool any_reflected_{false};
  std::optional<control::JointArray> held_;  // what was last sent in this session

  // handing over
  std::uint32_t activation_{0};
  bool active_{false};
  bool holding_{false};

  // what goes along
  FriOutputs outputs_;
  std::uint32_t writes_since_{0};  // the first answer that carried all of outputs_.writes
  bool writes_sent_{false};

  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::io
