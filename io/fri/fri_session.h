#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "control/ports.h"
#include "io/fri/codec.h"

namespace osteon::io {

/// Result for a datagram.
enum class FriAccept : std::uint8_t {
  kAccepted,   ///< newer than all before: its content is in the state. Or a measured joint is NaN or
               ///< infinite: the state then has the joints alone, and the message is not answered
  kDuplicate,  ///< seen before
  kReordered,  ///< overtaken by a newer one
  kRejected,   ///< not a valid message; last_error() gives the reason
};

/// Order of the torques in a Cartesian wrench on the wire.
enum class FriTorqueOrder : std::uint8_t {
  kZyx,  ///< about z, y, x: KUKA's A, B, C
  kXyz,
};

struct FriSessionParams {
  FriVersion version{FriVersion::k1_15};
  FriTorqueOrder torque_order{FriTorqueOrder::kZyx};  ///< not confirmed on an arm
  /// Largest distance of a joint from the interpolator's position in the first command of an activation; > 0.
  /// A command farther away is not followed.
  double entry_step_rad{0.02};
};

/// The client's side of an FRI session without the socket. In wall time FriLink carries the datagrams; in
/// virtual time they are passed in memory.
///
/// **Counters** are compared modulo 2^32. A gap counts as lost until the missing message arrives; the last 64
/// counters are remembered to tell reordered messages from duplicates. A counter further back belongs to a
/// new session of the arm, and is accepted if the message's state is MONITORING or IDLE, as sessions begin
/// there. In the other direction, the counter that the arm reflects tells which of our answers it received.
///
/// **Answers owed**, to every receiveMultiplier-th message:
///
///     IDLE                nothing
///     MONITORING_*        1.x: the arm's commanded position, mirrored; 2.x: the header alone
///     COMMANDING_WAIT     the arm's interpolator position, mirrored; in WRENCH or TORQUE mode also a zero
///                         wrench or torque, without which the session would end
///     COMMANDING_ACTIVE   the loop's position, and its wrench or torque
///
/// **No jump on return.** Each time COMMANDING_ACTIVE begins (or a gap of 64 messages might have hidden its
/// beginning) the interpolator's position is held, without wrench or torque, until a command names this
/// activation and starts near that position. A command that is not finite is never sent: the last position is
/// held. If the arm requests Cartesian poses, its own pose is mirrored.
///
/// Allocation-free unless noted; one thread at a time.
class FriSession {
 public:
  explicit FriSession(const FriSessionParams& params = {}) OSTEON_RT : params_(params),
                                                                       family_(FamilyOf(params.version)) {}

  /// Takes a datagram that arrived at `stamp`. Always sets the counters of `state`, and the rest only on
  /// kAccepted.
  FriAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// Whether the datagram can be read as a message of the arm; changes nothing.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// The datagram that answers the message last accepted; empty if no answer is due (yet) or it was already
  /// given. Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// Counts the message accepted before the last as late: it was not used, as a newer one was already
  /// waiting.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// Counts a datagram that was refused before it came here, e.g. for its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// Lets the next message begin a session, whatever its counter; the counts of ArmState continue.
  void ResetSession() OSTEON_RT;

  /// Why the last kRejected datagram was refused.
  [[nodiscard]] CodecError last_error() const OSTEON_RT { return last_error_; }
  /// The message last accepted: robot info, inputs and outputs, and other content that ArmState does not
  /// have. Default-constructed before the first.
  [[nodiscard]] const MonitoringMessage& message() const OSTEON_RT { return last_; }
  /// The arm's version family, if the arm was refused for another version than configured.
  [[nodiscard]] std::optional<FriFamily> other_family() const OSTEON_RT { return other_family_; }

  /// What keeps the arm from being commanded, in one or a few sentences; empty if nothing does. For screens
  /// and logs: allocates.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  // Compares the message's counter with those before, and counts lost, repeated and reordered messages.
  FriAccept CheckSequence(const MonitoringMessage& message) OSTEON_RT;
  // Counts lost and foreign answers by the counter that the arm reflects.
  void CheckReflected(const MonitoringMessage& message) OSTEON_RT;
  // Begins to hold the interpolator's position when COMMANDING_ACTIVE begins.
  void CheckActivation(const MonitoringMessage& message) OSTEON_RT;
  void BeginSession() OSTEON_RT;
  // Whether a command may be followed: it names this activation, is finite, and the first one starts near the
  // interpolator's position.
  [[nodiscard]] bool AcceptCommand(const control::ArmCommand& command) OSTEON_RT;
  // Fills in the joints, wrench, torques or pose that the session state and command mode require.
  void PutMotion(const control::ArmCommand& command, CommandMessage& answer) OSTEON_RT;
  void PutCounters(control::ArmState& state) const OSTEON_RT;

  struct Counters {
    std::uint32_t lost{0}, duplicate{0}, late{0}, reordered{0}, rejected{0}, other_version{0};
    std::uint32_t answers_lost{0}, answers_foreign{0};
  };

  FriSessionParams params_;
  FriFamily family_;
  MonitoringMessage last_;
  control::SessionState session_before_{control::SessionState::kIdle};  // before that of last_
  bool has_last_{false};
  std::uint64_t seen_{0};  // bit i: counter last_.sequence - i has arrived
  std::uint32_t due_{0};   // messages of the arm since our last answer, including lost ones
  bool pending_{false};    // last_ is not answered yet
  Counters counters_;
  CodecError last_error_{CodecError::kNone};
  std::optional<FriFamily> other_family_;

  // our answers
  std::uint32_t command_sequence_{1};  // of the next answer; an arm that has seen none reflects 0
  std::uint32_t first_answer_{1};      // of this session
  std::uint32_t reflected_{0};         // our newest answer that the arm has seen
  bool any_reflected_{false};
  std::optional<control::JointArray> held_;  // position last sent in this session

  // handing over
  std::uint32_t activation_{0};  // number of the present COMMANDING_ACTIVE
  bool active_{false};           // the last message was COMMANDING_ACTIVE
  bool holding_{false};          // until a command of this activation is accepted

  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::io
