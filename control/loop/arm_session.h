#pragma once

#include "base/marker.h"
#include "control/arm/message_gap.h"
#include "control/laws/impedance_law.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// State of the connection to the arm, derived from the arm's messages: whether the arm takes commands,
/// whether it has stayed in the activation in which motion began, its measured pose and velocity, whether it
/// stands still, and how many messages in a row were missed. An activation is one stay in COMMANDING_ACTIVE
/// (ArmState::activation).
class ArmSession {
 public:
  explicit ArmSession(const ServoParams& params);

  /// Call if no message came by the deadline, or one without finite joint positions.
  /// @returns true once WatchdogParams::arm_misses messages in a row were missed
  bool OnMissedMessage() OSTEON_RT;
  /// Call with each message whose joint positions are finite. @param X_WT  tool pose at the measured joints
  void OnMessage(const ArmState& state, const Pose& X_WT, rt::Nanoseconds now) OSTEON_RT;
  /// Counts the messages in a row in which the arm stood still. Call at the end of each tick that has a
  /// message.
  void UpdateStandstill(const JointArray& q_meas) OSTEON_RT;

  /// Whether the arm takes commands.
  /// @param moves  whether the loop moves or brakes the arm. If so, the result is also false if the arm has
  ///   left COMMANDING_ACTIVE and returned since motion began
  [[nodiscard]] bool TakesCommands(const ArmState& state, bool moves) const OSTEON_RT;
  /// Whether the arm has stayed in the activation in which motion began. If so, the arm is still at the
  /// loop's last command, although its interpolator reports the position at which the activation began.
  [[nodiscard]] bool IsSameActivation(const ArmState& state) const OSTEON_RT;
  /// Whether the arm's message period equals the loop's period. Each tick advances the loop's time by that
  /// period.
  [[nodiscard]] bool HasPeriod(const ArmState& state) const OSTEON_RT;
  /// Whether the arm's program asks for the kind of command that the law sends: a wrench or torque overlay
  /// for the impedance law, positions alone for the admittance law.
  [[nodiscard]] bool HasCommandMode(CommandMode mode) const OSTEON_RT;

  /// Call when motion begins: remembers the activation.
  void StartCommanding(const ArmState& state) OSTEON_RT;
  /// Call while the loop does not command the arm.
  void StopCommanding() OSTEON_RT { commanded_ = false; }
  /// Sets the measured velocity to zero at the last measured pose. Call when rendering begins.
  void ResetTwist() OSTEON_RT { twist_.Reset(X_WT_); }

  /// Call after a change of tool. The measured pose becomes that of the new tool, at rest.
  /// @param X_TN  pose of the new tool's frame in the old tool's frame
  void ChangeTool(const Pose& X_TN) OSTEON_RT {
    X_WT_ = X_WT_ * X_TN;
    twist_.Reset(X_WT_);
  }

  /// Activation in which motion last began.
  [[nodiscard]] std::uint32_t activation() const OSTEON_RT { return activation_; }
  /// Tool pose measured in the last message.
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return X_WT_; }
  /// Measured velocity of T at To, in W, filtered.
  [[nodiscard]] const Twist& V_WT() const OSTEON_RT { return twist_.V(); }
  /// Time between the last two messages, a multiple of the period [s].
  [[nodiscard]] double elapsed_s() const OSTEON_RT { return elapsed_s_; }
  /// Time of the tick with the last message; 0: none yet.
  [[nodiscard]] rt::Nanoseconds measured_at() const OSTEON_RT { return measured_at_; }
  /// Whether the arm stood still in each of the last kStandingMessages messages.
  [[nodiscard]] bool stands() const OSTEON_RT { return standing_ == kStandingMessages; }

  static constexpr int kStandingMessages = 10;

 private:
  const ServoParams& params_;
  MeasuredTwist twist_;
  MessageGap message_gap_;
  Pose X_WT_{Pose::Identity()};
  rt::Nanoseconds measured_at_{0};
  double elapsed_s_{0.0};
  JointArray q_seen_{};          // [rad] measured in the previous message
  int standing_{0}, missed_{0};  // numbers of messages in a row: with a standing arm; missed
  std::uint32_t activation_{0};
  bool commanded_{false};  // motion began in activation_, and no message has shown another activation since
};

/// Whether the tool's speed must be reduced: the arm is in operation mode T1, or reports no mode.
[[nodiscard]] bool HasReducedSpeed(const ArmState& state) OSTEON_RT;

/// Largest difference between the positions of the same joint in two arrays [rad].
[[nodiscard]] double MaxJointDifference(const JointArray& a, const JointArray& b) OSTEON_RT;

}  // namespace osteon::control
