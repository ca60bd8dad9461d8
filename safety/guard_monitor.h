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

/// Limits to which the guard holds a controller. Every field has a usable default but the arm and its place.
struct GuardParams {
  kinematics::ChainParams<7> arm{};  ///< geometry, and the joints' limits
  Pose X_WB{Pose::Identity()};       ///< the arm's base in world
  Pose X_FT{Pose::Identity()};       ///< tool in the flange's frame
  double period_s{0.001};            ///< of the arm's messages; > 0
  int receive_multiplier{1};         ///< the controller answers every n-th message; >= 1
  double joint_speed_share{0.9};     ///< of the joints' velocity limits, (0, 1]
  double max_speed_m_per_s{0.25};    ///< of the apex; > 0
  double max_turn_rad_per_s{1.5};    ///< of the tool; > 0
  /// Posture to which the controller takes the arm first. From the handing over until every joint has been
  /// within tolerance_rad of it, max_start_path_speed applies if it is the faster limit. Absent: there is no
  /// such path.
  std::optional<std::array<double, 7>> q_start{};
  double tolerance_rad{2e-3};                 ///< > 0
  double max_start_path_speed_m_per_s{0.25};  ///< of the apex; > 0
  double max_tracking_error_m{0.03};          ///< distance of the commanded from the measured apex; > 0
  double mirror_rad{0.02};           ///< largest distance from the interpolator while the arm waits; > 0
  WorkspaceParams workspace{};       ///< only its sphere and its plane
  double workspace_margin_m{0.002};  ///< tolerance beyond them; >= 0
  double max_force_N{200.0};         ///< of a wrench that the controller adds; > 0
  double max_torque_Nm{20.0};        ///< > 0
  double max_hand_force_N{250.0};    ///< of the hand, by the arm's estimate of external torques; > 0
  int hand_force_count{5};           ///< messages in a row beyond max_hand_force until the finding; >= 1
  /// How far beyond the controller's own limits on motion and hand the guard intervenes, so that a controlled
  /// stop comes first: 0.25 is a quarter. Does not apply to the arm's own limits or to rendered forces.
  double margin{0.25};
  double answer_age_s{0.005};  ///< longest time from an arm message to an answer that is not late; > 0
  double silence_s{0.05};      ///< longest time without an answer, else the motion request is withdrawn; > 0
};

/// State of the arm's session, as its message reports it.
enum class GuardSession : std::uint8_t {
  kIdle,
  kMonitoring,
  kWaiting,  ///< COMMANDING_WAIT: the controller mirrors
  kActive,   ///< COMMANDING_ACTIVE: the arm follows
};

using GuardJoints = std::array<double, 7>;

/// The content of an arm message that the guard uses.
struct GuardArmMessage {
  std::uint32_t sequence{0};
  GuardSession session{GuardSession::kIdle};
  GuardJoints q_meas{};                  ///< [rad]
  std::optional<GuardJoints> q_ipo{};    ///< [rad] the arm's interpolator; in kWaiting and kActive
  std::optional<GuardJoints> tau_ext{};  ///< [N·m] external, the arm's estimate
  bool compliant{false};                 ///< impedance control (WRENCH, TORQUE): positions set its springs
};

/// The content of a controller's answer that the guard uses. Untrusted: any value.
struct GuardCommand {
  std::uint32_t sequence{0}, reflected{0};
  std::optional<GuardJoints> q{};                 ///< [rad]
  std::optional<std::array<double, 6>> wrench{};  ///< force [N], torque [N·m] in any order
  std::optional<GuardJoints> tau{};               ///< [N·m]
  bool cartesian{false};                          ///< also commands a Cartesian pose
};

/// What becomes of a message.
enum class GuardDecision : std::uint8_t {
  kPass,      ///< forward to the other side
  kDrop,      ///< do not forward: a duplicate, late or overtaken. Nothing is latched
  kWithhold,  ///< the motion request is withdrawn; latched
};

/// Numbers of messages by what became of them.
struct GuardCounters {
  std::uint64_t passed{0};       ///< answers that may go on to the arm
  std::uint64_t late{0};         ///< answers to an older message than the newest, or too old
  std::uint64_t duplicate{0};    ///< answers to a message that was already answered
  std::uint64_t withheld{0};     ///< answers that broke a rule, and all after them
  std::uint64_t arm_dropped{0};  ///< messages of the arm that were duplicates or overtaken
};

/// Checks the traffic between arm and controller against the cell's limits. Calls no function of the servo
/// loop, of kinematics/ or of the rest of safety/, and shares only their parameters: GuardKinematics instead
/// of closed forms and serial chains, GuardZoneMargin_m instead of ZoneBounds, differences of commands
/// instead of velocities. tests/safety/guard_faults_test.cpp plants faults in the loop's functions.
///
/// A command to an arm that follows is passed if, with n the number of arm messages since the last passed
/// command,
///
///     q                     finite, within the joints' position limits
///     |q_i - before_i|      <= min(1, share (1 + margin)) v_i n period
///     |p_T - before|        <= v_max (1 + margin) n period, of the apex; the tool's rotation likewise
///     |p_T - measured|      <= max_tracking_error (1 + margin)
///     apex, flange, elbow   in their zones + workspace_margin; a zone counts once the arm has been inside
///                           since it was handed over
///     p_T                   in sphere and plane + workspace_margin; the sphere counts likewise
///     |f|, |t|              <= max_force, max_torque, of a wrench
///     |tau_i|               <= |Jv_i| max_force + |Jw_i| max_torque, of torques: the most that a wrench
///                           within the limits needs
///     reflected             the newest message of the arm, not older than answer_age, not answered yet
///
/// For a compliant arm, a command that moves toward the measured joints only relaxes its springs: only the
/// joints' speed is bounded, not the tool's.
///
/// A command that repeats the last one is checked for force, tracking and freshness alone: an arm that stands
/// outside may stay there. Besides commands the monitor checks the hand's force, by the arm's torques, and
/// the controller's silence.
///
/// Reads no clock: times come with the calls. The first finding is latched; from then on no command is
/// passed. No allocation; one thread at a time.
class GuardMonitor {
 public:
  /// @throws std::invalid_argument naming the parameter, what was found and what is accepted.
  explicit GuardMonitor(const GuardParams& params);

  /// Takes a message of the arm. kPass, or kDrop if it is not newer than the one before.
  GuardDecision OnArmMessage(const GuardArmMessage& message, rt::Nanoseconds arrival) OSTEON_RT;
  /// Checks an answer of the controller at the time `now`. Unless passed, it must not reach the arm.
  GuardDecision OnCommand(const GuardCommand& command, rt::Nanoseconds now) OSTEON_RT;
  /// Latches a datagram of the controller that is not a command.
  GuardDecision OnUnreadable(GuardFinding why) OSTEON_RT;
  /// Checks whether the controller is silent. To be called a few times within silence_s.
  void CheckSilence(rt::Nanoseconds now) OSTEON_RT;
  /// Resets the session: the next messages are another arm's, or this arm's after a restart.
  void ResetSession() OSTEON_RT;

  [[nodiscard]] bool latched() const OSTEON_RT { return reason_.finding != GuardFinding::kNone; }
  /// Whether the motion request stands: nothing is latched, and the controller has not left the arm alone. A
  /// controller that fell silent after it had brought the arm to rest, an ordinary end, may come back; its
  /// silence is not latched.
  [[nodiscard]] bool permits() const OSTEON_RT { return !latched() && !left_alone_; }
  /// Whether the arm is being commanded, by a message at most 0.1 s old.
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
  // In guard_rules.cpp. time_s: since the last command. kNone if nothing is wrong.
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
  // Each joint moves from the last command toward its measured position, at most up to it.
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

  bool answered_{false};  // the newest message of this session or an earlier one has an answer
  std::uint32_t answered_message_{0}, command_sequence_{0};
  bool commanding_{false};  // the last passed answer was to an arm that waits or follows
  bool rests_{true};        // the last passed answer told the arm to stand still
  bool unanswered_{false};  // a message was delivered to the controller, and no answer has passed since
  std::optional<rt::Nanoseconds> unanswered_since_;
  bool left_alone_{false};  // the controller fell silent, and has not answered since

  Joints q_before_{Joints::Zero()};  // last command
  std::uint32_t before_message_{0};  // message that the last command answered
  bool on_start_path_{false};        // the arm is still on its way to the start
  bool been_inside_{false};  // the apex has been in the workspace's sphere since the arm was handed over
  std::array<bool, kMaxZones> been_in_zone_{};  // likewise for each zone
};

}  // namespace osteon::safety
