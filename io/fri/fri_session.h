#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "control/ports.h"
#include "io/fri/codec.h"

namespace osteon::io {

/// Result of accepting a datagram.
enum class FriAccept : std::uint8_t {
  kAccepted,   ///< newer than all earlier messages; its content is in the state. Also if a measured joint is
               ///< NaN or infinite: then only the joints are in the state, and the message is not answered
  kDuplicate,  ///< received before
  kReordered,  ///< overtaken by a newer message
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
  /// Largest difference between a joint in the first command of an activation and the interpolator's
  /// position; > 0. A command with a larger difference is not sent.
  double entry_step_rad{0.02};
};

/// The client's side of an FRI session, without the socket. In wall time FriLink sends and receives the
/// datagrams; in virtual time they are passed in memory.
///
/// **Counters** of the arm's messages are compared modulo 2^32. The messages of a gap count as lost until
/// they arrive. The last 64 counters are stored to distinguish reordered messages from duplicates. A counter
/// that is more than 64 back belongs to a new session of the arm. It is accepted if the message's state is
/// MONITORING or IDLE, in which sessions begin. The counter that the arm reflects shows which of the client's
/// answers it has received.
///
/// **Answers** are due for every receiveMultiplier-th message. Content by session state:
///
///     IDLE                nothing
///     MONITORING_*        1.x: the arm's commanded position, mirrored; 2.x: only the header
///     COMMANDING_WAIT     the arm's interpolator position, mirrored; in WRENCH or TORQUE mode also a zero
/// ///                         wrench or torque, because the session would end without it
///     COMMANDING_ACTIVE   the loop's position, and the loop's wrench or torque
///
/// **No jump at the beginning of commanding.** When COMMANDING_ACTIVE begins (or may have begun unnoticed in
/// a gap of 64 messages), the session sends the interpolator's position, without wrench or torque, until a
/// command names this activation and starts near that position. A command that is not finite is never sent;
/// the last position is sent instead. If the arm requests Cartesian poses, its own pose is mirrored.
///
/// No allocation unless noted; one thread at a time.
class FriSession {
 public:
  explicit FriSession(const FriSessionParams& params = {}) OSTEON_RT : params_(params),
                                                                       family_(FamilyOf(params.version)) {}

  /// Processes a datagram that arrived at `stamp`. Always sets the counters of `state`; sets the other fields
  /// only if the result is kAccepted.
  FriAccept Accept(std::span<const std::uint8_t> datagram, rt::Nanoseconds stamp,
                   control::ArmState& state) OSTEON_RT;

  /// Whether the datagram can be decoded as a message of the arm. Changes nothing.
  [[nodiscard]] bool IsMessage(std::span<const std::uint8_t> datagram) const OSTEON_RT;

  /// Returns the datagram that answers the message last accepted; empty if no answer is due (yet) or the
  /// message was already answered. Valid until the next call.
  [[nodiscard]] std::span<const std::uint8_t> Answer(const control::ArmCommand& command) OSTEON_RT;

  /// Counts the last but one accepted message as late: it was not used, because a newer one was already
  /// waiting.
  void CountLate(control::ArmState& state) OSTEON_RT;
  /// Counts a datagram that was refused before it reached this session, e.g. because of its sender.
  void CountRejected(control::ArmState& state) OSTEON_RT;

  /// The next message will begin a session, with any counter. The counters of ArmState continue.
  void ResetSession() OSTEON_RT;

  /// Reason why the last kRejected datagram was refused.
  [[nodiscard]] CodecError last_error() const OSTEON_RT { return last_error_; }
  /// The message last accepted. It contains robot info, inputs and outputs, and other content that ArmState
  /// does not have. Default-constructed before the first message.
  [[nodiscard]] const MonitoringMessage& message() const OSTEON_RT { return last_; }
  /// The arm's version family, if the arm was refused for another version than configured.
  [[nodiscard]] std::optional<FriFamily> other_family() const OSTEON_RT { return other_family_; }

  /// Returns in a few sentences what prevents the arm from being commanded; empty if nothing does. For
  /// screens and logs: allocates.
  [[nodiscard]] std::string Diagnosis() const;

 private:
  // Compares the message's counter with the earlier ones, and counts lost, repeated and reordered messages.
  FriAccept CheckSequence(const MonitoringMessage& message) OSTEON_RT;
  // Counts lost answers, and answers of another client, from the counter that the arm reflects.
  void CheckReflected(const MonitoringMessage& message) OSTEON_RT;
  // Begins to hold the interpolator's position when COMMANDING_ACTIVE begins.
  void CheckActivation(const MonitoringMessage& message) OSTEON_RT;
  void BeginSession() OSTEON_RT;
  // Whether a command may be sent to the arm. It must name this activation and be finite; the first command
  // of an activation must also start near the interpolator's position.
  [[nodiscard]] bool AcceptCommand(const control::ArmCommand& command) OSTEON_RT;
  // Sets the joints, wrench, torques or pose of `answer` that the session state and command mode require.
  void PutMotion(const control::ArmCommand& command, CommandMessage& answer) OSTEON_RT;
  void PutCounters(control::ArmState& state) const OSTEON_RT;

  struct Counters {
    std::uint32_t lost{0}, duplicate{0}, late{0}, reordered{0}, rejected{0}, other_version{0};
    std::uint32_t answers_lost{0}, answers_foreign{0};
  };

  FriSessionParams params_;
  FriFamily family_;
  MonitoringMessage last_;
  control::SessionState session_before_{control::SessionState::kIdle};  // session state before that of last_
  bool has_last_{false};
  std::uint64_t seen_{0};  // bit i: counter last_.sequence - i has arrived
  std::uint32_t due_{0};   // number of the arm's messages since the last answer, including lost ones
  bool pending_{false};    // last_ is not answered yet
  Counters counters_;
  CodecError last_error_{CodecError::kNone};
  std::optional<FriFamily> other_family_;

  // our answers
  // sequence number of the next answer; an arm that has received no answer reflects 0
  std::uint32_t command_sequence_{1};
  std::uint32_t first_answer_{1};  // sequence number of this session's first answer
  std::uint32_t reflected_{0};     // sequence number of the newest answer that the arm has received
  bool any_reflected_{false};
  std::optional<control::JointArray> held_;  // position last sent in this session

  // handing over
  std::uint32_t activation_{0};  // number of the present COMMANDING_ACTIVE
  bool active_{false};           // the last message was COMMANDING_ACTIVE
  bool holding_{false};          // no command of this activation has been accepted yet

  std::array<std::uint8_t, kFriMaxDatagram> buffer_{};
};

}  // namespace osteon::io
