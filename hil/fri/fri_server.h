#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/clock.h"
#include "control/ports.h"
#include "hil/fri/fri_codec.h"
#include "hil/fri/fri_drives.h"
#include "hil/fri/fri_stop.h"
#include "hil/fri/link_quality.h"
#include "kinematics/lbr_arm.h"

namespace osteon::hil {

/// How the client notices that the arm has ended a session.
enum class SessionEnd : std::uint8_t {
  kSilence,  ///< no further message
  /// After MONITORING_READY, a few messages with the state IDLE, then none. This is the behaviour in a public
  /// log of an arm: github.com/lbr-stack/lbr_fri_ros2_stack, issue 251.
  kIdleMessages,
};

/// Parameters of the arm's side of a session.
struct FriServerParams {
  io::FriVersion version{io::FriVersion::k1_15};
  int send_period_ms{1};      ///< 1, 2, 5 or 10 on real arms; 1 … 100 here
  int receive_multiplier{1};  ///< the client owes one answer for each group of this many messages
  QualityPolicyParams quality{};
  control::ControlMode control_mode{control::ControlMode::kPosition};
  control::CommandMode command_mode{control::CommandMode::kPosition};  ///< kPosition, kWrench or kTorque
  bool torques_zyx{true};  ///< order of a wrench's torques on the wire. True: about z, y, x (KUKA's A, B, C);
                           ///< false: x, y, z
  /// The robot program requests commanding after more than this many consecutive cycles in MONITORING_READY
  /// with active drives.
  int request_after_good_cycles{200};
  /// Mirrored answers in COMMANDING_WAIT after which COMMANDING_ACTIVE begins.
  int activate_after_mirrored_answers{50};
  /// The robot program requests commanding again after losses have ended it.
  bool request_again_after_loss{false};
  /// A command may move a joint by at most step_margin × velocity limit × time since the last accepted
  /// command.
  double step_margin{1.1};
  /// Tolerance of each joint of an answer in COMMANDING_WAIT, which must mirror the interpolator's position.
  double mirror_tolerance_rad{1e-3};
  /// Largest joint's tracking error at which trackingPerformance becomes 0. It is 1 without an error, and
  /// linear in between.
  double tracking_error_zero_rad{0.1};
  /// Largest distance of a commanded joint from its measured position in impedance control; assumed.
  double max_axis_delta_rad{0.1};
  /// Time from the acknowledgement of a stop until the drives are ACTIVE; assumed.
  double drive_start_s{0.5};
  double close_s{5.0};  ///< time from Close() to IDLE
  SessionEnd session_end{SessionEnd::kSilence};
  double external_torque_cutoff_hz{0.0};  ///< low-pass filter of the estimated external torque; 0: none
  /// Offset of the estimated external torque while nobody touches the arm, e.g. because of a wrong payload.
  kinematics::JointVector external_torque_offset_Nm{kinematics::JointVector::Zero()};
};

/// Counters of datagrams since construction.
struct FriCounters {
  std::uint64_t sent{0};
  std::uint64_t answered{0};       ///< due answers that arrived in time and complete
  std::uint64_t lost{0};           ///< due answers that were late, incomplete or missing
  std::uint64_t excused{0};        ///< due answers that did not arrive because the arm itself was late
  std::uint64_t stale{0};          ///< answers to an earlier message than the present one
  std::uint64_t duplicate{0};      ///< second answers to one message
  std::uint64_t malformed{0};      ///< datagrams that are not a valid command message
  std::uint64_t other_version{0};  ///< those among malformed that are a command message of another version
  /// Answers without the joint position, wrench or torque that state and mode require.
  std::uint64_t incomplete{0};
  /// Answers that command a motion outside the commanding states, e.g. after a stop.
  std::uint64_t ignored{0};
  std::uint64_t client_gap{0};  ///< gaps in the client's sequence numbers: answers that never arrived
  /// Answers whose sequence number did not rise: there are two clients, or the client has restarted.
  std::uint64_t client_back{0};
};

/// The arm's measurements, sent with the next message.
struct ArmMeasurement {
  kinematics::JointVector q{kinematics::JointVector::Zero()};  ///< [rad]
  /// [N·m] measured by the joints' torque sensors; zero if the model has none.
  kinematics::JointVector tau_meas{kinematics::JointVector::Zero()};
  kinematics::JointVector tau_ext{kinematics::JointVector::Zero()};  ///< [N·m] caused by external loads
  PlainPose X_BC{};     ///< pose of the motion centre C in the robot's base
  PlainWrench F_C_C{};  ///< external wrench on C, in C
};

/// The arm's end of an FRI session with joint overlay. It converts received bytes to bytes to send; it has no
/// socket and no clock.
///
///     IDLE ──Open──▶ MONITORING_WAIT ◀──quality──▶ MONITORING_READY ──program asks──▶ COMMANDING_WAIT
///       ▲                  ▲      │                                                       │ mirrored
///       └── Close, timeout ┼──────┘                                                       │
///                          └──────── losses, safety stop ──────── COMMANDING_ACTIVE ◀─────┘
///
/// The calls of one cycle (one send period) are: Receive() for each datagram that came, EndCycle(), advance
/// the arm toward q_commanded(), BeginCycle(). In IDLE the arm sends nothing except the messages of
/// SessionEnd::kIdleMessages. An answer is evaluated in the state that was sent with the message that it
/// answers.
///
/// **Commanding begins** if quality is GOOD, the drives are active, there is no safety stop, and the control
/// mode fits the command mode: WRENCH needs Cartesian impedance, TORQUE joint impedance, POSITION any control
/// mode. In WRENCH and TORQUE mode each answer in the COMMANDING states must contain a wrench or torques,
/// respectively; otherwise it counts as lost.
///
/// In COMMANDING_ACTIVE a command must have seven finite joint values within the position limits. It may not
/// move a joint further than its velocity limit allows since the last accepted command (lost commands
/// lengthen that time). In impedance control it must stay near the measured position. If a command violates
/// one of these rules, a safety stop begins and lasts until Acknowledge(). Without a new command, the arm
/// keeps the last accepted joints and overlay. In every other state it holds the last accepted joints,
/// without wrench or torque. The interpolator's position (ipo) stays where commanding began.
///
/// Real arms also interpolate commands and brake along a path; this is not modelled.
class FriServer {
 public:
  /// @param limits only position and velocity limits are used; lower < upper, velocity > 0.
  /// @throws std::invalid_argument on a parameter out of range or q_start [rad] outside the limits.
  FriServer(const FriServerParams& params, const std::array<kinematics::JointLimits, 7>& limits,
            const kinematics::JointVector& q_start);

  /// Opens the session, as the robot program does. Counters continue.
  void Open();
  /// Ends commanding at once and the session after close_s.
  void Close() { CloseAfter(params_.close_s); }
  /// As Close(), with `seconds` >= 0 instead of close_s, for example when the program is cancelled at the
  /// pad.
  void CloseAfter(double seconds);
  [[nodiscard]] SessionEnd session_end() const { return params_.session_end; }

  /// Applies a safety stop from outside, e.g. the emergency stop. @param level 0 … 2
  void EmergencyStop(int level);
  /// Cuts the drives' power: a stop 0.
  void PowerOff();
  /// Acknowledges the stop and restarts the program.
  void Acknowledge();
  /// Sets the modes, as the robot program does between two motions. Returns false without a change while
  /// commanding.
  bool SetModes(control::ControlMode control_mode, control::CommandMode command_mode);

  /// Accepts one datagram of the client, which may be malformed. Returns true if it answers the present
  /// message.
  bool Receive(std::span<const std::uint8_t> datagram);

  /// Evaluates what was received since BeginCycle and advances the session.
  /// @param client_had_its_time false if the arm itself was late or early: a missing answer is then excused.
  void EndCycle(bool client_had_its_time = true);

  /// Returns the next monitoring message; empty if none is sent (IDLE); valid until the next call.
  /// @param stamp the message's time stamp; >= 0.
  [[nodiscard]] std::span<const std::uint8_t> BeginCycle(const ArmMeasurement& measured,
                                                         rt::Nanoseconds stamp);

  /// Target of the arm's servo [rad].
  [[nodiscard]] const kinematics::JointVector& q_commanded() const { return q_commanded_; }
  /// The client's wrench overlay on the motion centre, in the motion centre's frame; zero outside WRENCH
  /// mode.
  [[nodiscard]] const Wrench& F_commanded() const { return F_commanded_; }
  /// The client's torque overlay [N·m]; zero outside TORQUE mode.
  [[nodiscard]] const kinematics::JointVector& tau_commanded() const { return tau_commanded_; }
  [[nodiscard]] control::ControlMode control_mode() const { return params_.control_mode; }
  [[nodiscard]] const FriDrives& drives() const { return drives_; }
  [[nodiscard]] control::SessionState state() const { return state_; }
  [[nodiscard]] int quality() const { return quality_.level(); }
  [[nodiscard]] const FriCounters& counters() const { return counters_; }
  [[nodiscard]] const StopReport& stop() const { return stop_; }  ///< the last stop; none once acknowledged
  [[nodiscard]] double period_s() const { return 1e-3 * params_.send_period_ms; }

 private:
  [[nodiscard]] bool Commanding() const;
  // At the end of a turn, counts its answer as received, excused or lost.
  void CountAnswer(bool client_had_its_time);
  // Counts gaps and steps back in the client's own numbering.
  void CountClientSequence(std::uint32_t sequence);
  void CountIgnored();
  // Whether the pending answer contains the fields that the command mode requires.
  [[nodiscard]] bool HasRequiredFields() const;
  void StepMonitoring();
  void EndSession();
  void AskForCommanding();
  void StepCommandingWait();
  void ApplyCommand();
  [[nodiscard]] bool ApplyOverlay();
  // Returns to a monitoring state, and clears wrench and torques.
  void LeaveCommanding();
  // If too many answers were lost, reports that in stop_. @returns true in that case
  [[nodiscard]] bool ReportLosses();
  void EndOnLosses();
  // Switches the drives off and leaves commanding. The first overload stops with level 1.
  void SafetyStop(StopReason reason, int joint, double found, double accepted);
  void SafetyStop(const StopReport& report, int level);
  [[nodiscard]] StopReport Report(StopReason reason, int joint, double found, double accepted) const;

  FriServerParams params_;
  std::array<kinematics::JointLimits, 7> limits_;
  FriCodec codec_;
  LinkQuality quality_;
  FriCounters counters_;
  StopReport stop_;

  control::SessionState state_{control::SessionState::kIdle};
  FriDrives drives_;
  bool program_asks_{true};  // the robot program requests commanding once the quality is GOOD
  int closing_cycles_{0};    // cycles until IDLE; 0: the session is not closing
  int idle_messages_{0};     // number of messages still to send in IDLE
  int cycles_in_session_{0};
  bool was_good_{false};
  int good_cycles_{0};
  int mirrored_{0};  // answers in COMMANDING_WAIT that repeated the interpolator's position
  int cycles_since_command_{0};
  kinematics::JointVector q_commanded_, q_ipo_, q_measured_;
  PlainPose X_measured_, X_ipo_;
  // filtered estimate, without the offset
  kinematics::JointVector tau_estimated_{kinematics::JointVector::Zero()};
  kinematics::JointVector tau_commanded_{kinematics::JointVector::Zero()};
  Wrench F_commanded_;

  std::uint32_t sequence_{0};           // sequence number of the message last sent
  std::uint32_t client_sequence_{0};    // sequence number of the last accepted answer
  std::uint32_t answered_sequence_{0};  // sequence number of the message that this answer belongs to
  bool any_answer_{false};
  bool has_pending_{false};  // an answer was accepted since BeginCycle
  FriCommand pending_;
  // A turn: receive_multiplier cycles, in which one answer is due.
  int cycles_in_turn_{0};
  bool turn_answered_{false};
  bool turn_excused_{false};
};

}  // namespace osteon::hil
