#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "control/ports.h"
#include "control/rt/clock.h"
#include "hil/fri_codec.h"
#include "hil/link_quality.h"
#include "kinematics/lbr_arm.h"

namespace osteon::hil {

/// The arm's side of a session.
struct FriServerParams {
  int send_period_ms{1};
  int receive_multiplier{1};  ///< the client owes an answer to one message in this many
  QualityPolicyParams quality{};
  int request_after_good_cycles{
      200};  ///< the robot program asks for commanding after so many cycles in MONITORING_READY
  int activate_after_mirrored_answers{50};  ///< answers in COMMANDING_WAIT before the motion is handed over
  bool request_again_after_loss{false};  ///< the robot program asks again after losses ended the commanding
  double step_margin{1.1};  ///< a command may move a joint by velocity limit × time since the last one × this
  double mirror_tolerance_rad{
      1e-3};  ///< COMMANDING_WAIT: how far from the interpolator's position an answer may be
  double tracking_error_zero_rad{
      0.1};  ///< largest joint error at which trackingPerformance reads 0; 0 error reads 1
};

/// Why the arm ended commanding or closed the session.
enum class StopReason : std::uint8_t {
  kNone,
  kQualityTimeout,  ///< the session closes
  kLostInARow,      ///< the arm holds; back to monitoring
  kLostPerSecond,   ///< the same
  kNotMirrored,     ///< this and the following: safety stop, level 1; the drives go off
  kJointCount,
  kNotFinite,
  kJointLimit,
  kJointStep,
};

/// What stopped the arm, with the figures that did.
struct StopReport {
  StopReason reason{StopReason::kNone};
  std::uint32_t sequence{0};  ///< of the monitoring message whose answer it was
  int joint{0};               ///< 1 … 7 where one joint is to blame, otherwise 0
  double found{0.0};          ///< rad, answers, or joints, by reason
  double accepted{0.0};       ///< the bound, in the same unit
};

/// One line for a screen, e.g. "joint step: A4 moved 0.0120 rad in one command, accepted 0.0014".
[[nodiscard]] std::string Describe(const StopReport& stop);

/// Datagrams so far.
struct FriCounters {
  std::uint64_t sent{0};
  std::uint64_t answered{0};    ///< answers due that came in time, complete
  std::uint64_t lost{0};        ///< answers due that did not
  std::uint64_t excused{0};     ///< the same, but the arm itself was late
  std::uint64_t stale{0};       ///< answers to a message that is no longer the current one
  std::uint64_t duplicate{0};   ///< second answers to one message
  std::uint64_t malformed{0};   ///< not a command message
  std::uint64_t incomplete{0};  ///< without the joint position that the state asks for
};

/// What the arm measures; goes out with the next message.
struct ArmMeasurement {
  kinematics::JointVector q{kinematics::JointVector::Zero()};        ///< [rad]
  kinematics::JointVector tau_ext{kinematics::JointVector::Zero()};  ///< [N·m]
};

/// The arm's end of FRI 1.15 in POSITION mode with joint overlay: bytes in, bytes out, no socket and no
/// clock.
///
///     IDLE ──Open──▶ MONITORING_WAIT ◀──quality──▶ MONITORING_READY ──program asks──▶ COMMANDING_WAIT
///                          ▲                                                              │ mirrored
///                          └──────── losses, safety stop ──────── COMMANDING_ACTIVE ◀─────┘
///
/// A cycle, once each send period: Receive() for each datagram that came, EndCycle(), advance the arm toward
/// q_commanded(), BeginCycle(). In IDLE the arm sends nothing. The state that a message names is the one that
/// its answer is judged by.
///
/// In COMMANDING_ACTIVE a command must have seven finite joint values within the position limits, and may not
/// move a joint further than its velocity limit allows since the last accepted command (lost ones lengthen
/// that time); otherwise a safety stop that lasts. Without a new command, and in every other state, the arm
/// holds the last accepted one. The interpolator's position (ipo) rests where commanding began.
///
/// Real arms interpolate, brake along a path and need to be acknowledged after a stop: not modelled here.
class FriServer {
 public:
  /// @param limits position and velocity limits are used; lower < upper, velocity > 0.
  /// @throws std::invalid_argument on a parameter out of range or q_start [rad] outside the limits.
  FriServer(const FriServerParams& params, const std::array<kinematics::JointLimits, 7>& limits,
            const kinematics::JointVector& q_start);

  /// Opens the session, as the robot program does. Counters go on.
  void Open();

  /// One datagram of the client, however odd. True where it answers the current message.
  bool Receive(std::span<const std::uint8_t> datagram);

  /// Judges what was received since BeginCycle and moves the session on.
  /// @param client_had_its_time false where the arm itself was late or early: a missing answer is then
  /// excused.
  void EndCycle(bool client_had_its_time = true);

  /// The next monitoring message, empty in IDLE; valid until the next call.
  /// @param stamp goes out as the message's time stamp; >= 0.
  [[nodiscard]] std::span<const std::uint8_t> BeginCycle(const ArmMeasurement& measured,
                                                         rt::Nanoseconds stamp);

  /// Where the arm's servo should go [rad].
  [[nodiscard]] const kinematics::JointVector& q_commanded() const { return q_commanded_; }
  [[nodiscard]] control::SessionState state() const { return state_; }
  [[nodiscard]] int quality() const { return quality_.level(); }
  [[nodiscard]] const FriCounters& counters() const { return counters_; }
  [[nodiscard]] const StopReport& stop() const { return stop_; }  ///< the last one
  [[nodiscard]] double period_s() const { return 1e-3 * params_.send_period_ms; }

 private:
  [[nodiscard]] bool Commanding() const;
  void CountAnswer(bool client_had_its_time);
  void WalkMonitoring();
  void WalkCommandingWait();
  void Follow();
  void LeaveCommanding();
  void EndOnLosses();
  void SafetyStop(StopReason reason, int joint, double found, double accepted);
  [[nodiscard]] StopReport Report(StopReason reason, int joint, double found, double accepted) const;

  FriServerParams params_;
  std::array<kinematics::JointLimits, 7> limits_;
  FriCodec codec_;
  LinkQuality quality_;
  FriCounters counters_;
  StopReport stop_;

  control::SessionState state_{control::SessionState::kIdle};
  bool safety_stopped_{false};
  bool program_asks_{true};
  int cycles_in_session_{0};
  bool was_good_{false};
  int good_cycles_{0};
  int mirrored_{0};
  int cycles_since_command_{0};
  kinematics::JointVector q_commanded_, q_ipo_;

  std::uint32_t sequence_{0};           // of the message last sent
  std::uint32_t client_sequence_{0};    // of the answer last taken
  std::uint32_t answered_sequence_{0};  // the message that it answered
  bool any_answer_{false};
  bool has_pending_{false};  // an answer since BeginCycle
  FriCommand pending_;
  // A turn: receive_multiplier cycles, in which one answer is due.
  int cycles_in_turn_{0};
  bool turn_answered_{false};
  bool turn_excused_{false};
};

}  // namespace osteon::hil
