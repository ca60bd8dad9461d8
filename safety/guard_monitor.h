#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/clock.h"
#include "base/marker.h"
#include "safety/guard_kinematics.h"
#include "safety/guard_reason.h"
#include "safety/workspace.h"

namespace osteon::safety {

/// Limits that the guard enforces on a controller. Every field has a usable default, except `arm`, `X_WB` and
/// `X_FT`.
struct GuardParams {
  kinematics::ChainParams<7> arm{};  ///< geometry, and the joints' limits
  Pose X_WB{Pose::Identity()};       ///< the arm's base in world
  Pose X_FT{Pose::Identity()};       ///< tool in the flange's frame
  double period_s{0.001};            ///< period of the arm's messages; > 0
  int receive_multiplier{1};         ///< the controller answers every n-th message; >= 1
  double joint_speed_share{0.9};     ///< usable share of the joints' velocity limits, (0, 1]
  double max_speed_m_per_s{0.25};    ///< of the apex; > 0
  double max_turn_rad_per_s{1.5};    ///< of the tool; > 0
  /// Posture to which the controller moves the arm first. From the hand-over of the arm until every joint is
  /// within tolerance_rad of this posture, max_start_path_speed applies instead of max_speed if it is larger.
  /// Absent: there is no such path.
  std::optional<std::array<double, 7>> q_start{};
  double tolerance_rad{2e-3};                 ///< > 0
  double max_start_path_speed_m_per_s{0.25};  ///< of the apex; > 0
  double max_tracking_error_m{0.03};          ///< largest distance between commanded and measured apex; > 0
  /// largest distance of a commanded joint from the arm's interpolator in COMMANDING_WAIT; > 0
  double mirror_rad{0.02};
  WorkspaceParams workspace{};       ///< only its sphere and its plane
  double workspace_margin_m{0.002};  ///< tolerance beyond sphere, plane and zones; >= 0
  double max_force_N{200.0};         ///< largest force of a wrench that the controller adds; > 0
  double max_torque_Nm{20.0};        ///< > 0
  /// largest force of the hand, estimated from the arm's external torques; > 0
  double max_hand_force_N{250.0};
  /// number of consecutive messages beyond max_hand_force_N that gives a finding; >= 1
  int hand_force_count{5};
  /// The guard's limits on motion and hand force are the controller's own limits times (1 + margin), so that
  /// the controller's stop comes first. The margin does not apply to the arm's own limits or to rendered
  /// forces.
  double margin{0.25};
  double answer_age_s{0.005};  ///< an answer that comes later than this after the arm's message is late; > 0
  double silence_s{0.05};  ///< without an answer for longer than this, the motion request is withdrawn; > 0
};

/// State of the arm's session, as its message reports it.
enum class GuardSession : std::uint8_t {
  kIdle,
  kMonitoring,
  kWaiting,  ///< COMMANDING_WAIT: the controller has to command the arm's own interpolator position
  kActive,   ///< COMMANDING_ACTIVE: the arm follows the commands
};

using GuardJoints = std::array<double, 7>;

/// The content of an arm message that the guard uses.
struct GuardArmMessage {
  std::uint32_t sequence{0};
  GuardSession session{GuardSession::kIdle};
  GuardJoints q_meas{};                ///< [rad]
  std::optional<GuardJoints> q_ipo{};  ///< [rad] position of the arm's interpolator; in kWaiting and kActive
  std::optional<GuardJoints> tau_ext{};  ///< [N·m] external torques, estimated by the arm
  bool compliant{false};  ///< the arm is in impedance control (command mode WRENCH or TORQUE), where
                          ///< positions are the rest positions of its springs
};

/// The content of a controller's answer that the guard uses. Values may be anything, since they are not
/// checked yet.
struct GuardCommand {
  std::uint32_t sequence{0}, reflected{0};
  std::optional<GuardJoints> q{};                 ///< [rad]
  std::optional<std::array<double, 6>> wrench{};  ///< force [N], then torque [N·m], each in any order of axes
  std::optional<GuardJoints> tau{};               ///< [N·m]
  bool cartesian{false};                          ///< the answer also commands a Cartesian pose
};

/// The guard's decision about a message.
enum class GuardDecision : std::uint8_t {
  kPass,      ///< forward to the arm or the controller
  kDrop,      ///< do not forward, because the message is a duplicate, late or overtaken; nothing is latched
  kWithhold,  ///< do not forward, and withdraw the motion request; latched
};

/// Numbers of messages by the guard's decision.
struct GuardCounters {
  std::uint64_t passed{0};       ///< answers that were passed to the arm
  std::uint64_t late{0};         ///< answers to a message that is too old, or that came too late
  std::uint64_t duplicate{0};    ///< answers to a message that was already answered
  std::uint64_t withheld{0};     ///< the first answer that broke a rule, and all later answers
  std::uint64_t arm_dropped{0};  ///< messages of the arm that were duplicates or overtaken
};

/// Checks the traffic between arm and controller against the cell's limits. Calls no function of the servo
/// loop, of kinematics/ or of the rest of safety/, and shares only their parameters, so that errors there are
/// detected. It uses GuardKinematics instead of closed forms and serial chains, GuardZoneMargin_m instead of
/// ZoneBounds, and differences of commands instead of velocities. tests/safety/guard_faults_test.cpp tests
/// this with faults in the loop's functions.
///
/// A command to an arm in COMMANDING_ACTIVE is passed if all of these hold. n is the number of arm messages
/// since the last passed command (at most 10), v_i the velocity limit of joint i:
///
///     q                     finite, within the joints' position limits
///     |q_i - before_i|      <= min(1, share (1 + margin)) v_i n period
///     |p_T - before|        <= v_max (1 + margin) n period, of the apex; the same for the tool's rotation
///     |p_T - measured|      <= max_tracking_error (1 + margin)
///     apex, flange, elbow   in their zones + workspace_margin
///     p_T                   in sphere and plane + workspace_margin
///     |f|, |t|              <= max_force, max_torque, of a wrench
///     |tau_i|               <= |Jv_i| max_force + |Jw_i| max_torque, of torques
///     reflected             one of the arm's last receive_multiplier messages, not answered yet, in time
///                           (the arm's newest message is not older than answer_age)
///
/// A zone or the sphere is enforced once its point has been inside since the arm was handed over. The bound
/// of |tau_i| is the largest torque that a wrench within the limits needs at joint i.
///
/// For a compliant arm, a command that moves toward the measured joint positions only relaxes the arm's
/// springs. For such a command only the joints' speed is bounded, not the tool's.
///
/// A command that repeats the last position is checked only for force, tracking and freshness, so that an arm
/// that stands outside its bounds may stay there. Besides commands the monitor checks the hand's force,
/// estimated from the arm's external torques, and whether the controller is silent.
///
/// Reads no clock: times come with the calls. The first finding is latched; from then on no command is
/// passed. No allocation; one thread at a time.
class GuardMonitor {
 public:
  /// @throws std::invalid_argument naming the parameter, what was found and what is accepted.
  explicit GuardMonitor(const GuardParams& params);

  /// Processes a message of the arm. Returns kPass, or kDrop if it is not newer than the one before.
  GuardDecision OnArmMessage(const GuardArmMessage& message, rt::Nanoseconds arrival) OSTEON_RT;
  /// Checks an answer of the controller at the time `now`. The answer may be sent to the arm only if the
  /// result is kPass.
  GuardDecision OnCommand(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT;
  /// Latches the finding that a datagram of the controller is not a valid command.
  GuardDecision OnUnreadable(GuardFinding why) OSTEON_RT;
  /// Checks whether the controller is silent. Call it several times within silence_s.
  void CheckSilence(rt::Nanoseconds now) OSTEON_RT;
  /// Resets the session, because the next messages come from another arm, or from this arm after a restart.
  void ResetSession() OSTEON_RT;

  [[nodiscard]] bool latched() const OSTEON_RT { return reason_.finding != GuardFinding::kNone; }
  /// Whether the guard requests motion from the PLC: nothing is latched, and the controller is not silent. If
  /// the controller fell silent after it had brought the arm to rest (an ordinary end), the silence is not
  /// latched, and the controller may come back.
  [[nodiscard]] bool permits() const OSTEON_RT { return !latched() && !left_alone_; }
  /// Whether the arm's newest message is at most 0.1 s old and says that the arm is being commanded.
  [[nodiscard]] bool ArmIsCommanded(rt::Nanoseconds now) const OSTEON_RT {
    return has_arm_ && arm_message_.session >= GuardSession::kWaiting &&
           now - arm_arrival_ < 100 * rt::kMillisecond;
  }
  [[nodiscard]] const GuardReason& reason() const OSTEON_RT { return reason_; }
  [[nodiscard]] const GuardCounters& counters() const OSTEON_RT { return counters_; }

 private:
  using Joints = GuardKinematics::Joints;
  static constexpr std::size_t kMaxZones = 16;

  [[nodiscard]] static Joints ToJoints(const GuardJoints& q) OSTEON_RT {
    return Eigen::Map<const Joints>(q.data());
  }
  // 1 … 7: the first joint that is not finite; 0: all are finite.
  [[nodiscard]] static int FirstNotFinite(const Joints& q) OSTEON_RT {
    for (int i = 0; i < 7; ++i)
      if (!std::isfinite(q[i])) return i + 1;
    return 0;
  }
  // Defined in guard_rules.cpp. Return kNone if nothing is wrong. time_s: time since the last command.
  [[nodiscard]] GuardReason CheckJoints(const Joints& q, double time_s) const OSTEON_RT;
  [[nodiscard]] GuardReason CheckTool(const Joints& q, double time_s) OSTEON_RT;
  [[nodiscard]] GuardReason CheckPlacement(const GuardKinematics::Placement& arm) OSTEON_RT;
  [[nodiscard]] GuardReason CheckZones(const GuardKinematics::Placement& arm) OSTEON_RT;
  [[nodiscard]] GuardReason CheckOverlay(const GuardCommand& command) const OSTEON_RT;

  void CheckHandForce(const GuardArmMessage& message) OSTEON_RT;
  bool IsFresh(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT;
  [[nodiscard]] GuardReason CheckCommand(const GuardCommand& command) OSTEON_RT;
  // Whether every joint is within tolerance_rad of q_start; true without a q_start.
  [[nodiscard]] bool AtStart(const Joints& q) const OSTEON_RT;
  // Whether each joint moves from the last command toward its measured position, and not beyond it.
  [[nodiscard]] bool Relaxes(const Joints& q) const OSTEON_RT;
  // Keeps the first finding; later ones change nothing.
  void Latch(const GuardReason& reason) OSTEON_RT;

  GuardParams params_;
  GuardKinematics arm_;
  GuardReason reason_;
  GuardCounters counters_;

  GuardArmMessage arm_message_;  // the newest
  rt::Nanoseconds arm_arrival_{0};
  bool has_arm_{false};
  int hand_force_messages_{0};  // messages in a row beyond max_hand_force_N

  bool answered_{false};  // an answer has passed in this session
  std::uint32_t answered_message_{0}, command_sequence_{0};
  bool commanding_{false};  // the last passed answer went to an arm in COMMANDING_WAIT or COMMANDING_ACTIVE
  bool rests_{true};        // the last passed answer told the arm to stand still
  bool unanswered_{false};  // a message was delivered to the controller, and no answer has passed since
  std::optional<rt::Nanoseconds> unanswered_since_;
  bool left_alone_{false};  // the controller fell silent, and has not answered since

  Joints q_before_{Joints::Zero()};  // joint positions of the last command
  std::uint32_t before_message_{0};  // message that the last command answered
  bool on_start_path_{false};        // the arm has not yet reached q_start
  bool been_inside_{false};  // the apex has been in the workspace's sphere since the arm was handed over
  // for each zone: its point has been inside since the arm was handed over
  std::array<bool, kMaxZones> been_in_zone_{};
};

}  // namespace osteon::safety
