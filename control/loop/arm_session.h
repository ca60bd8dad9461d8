#pragma once

#include "base/marker.h"
#include "control/arm/message_gap.h"
#include "control/laws/impedance_law.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "kinematics/spatial.h"

namespace osteon::control {

/// The connection to the arm, as its messages tell it: whether the arm takes commands, whether it is still
/// the activation that was commanded, how far and how fast it has moved, whether it stands, and how many
/// messages were missed.
class ArmSession {
 public:
  explicit ArmSession(const ServoParams& params);

  /// No message came by the deadline, or one that says nothing. @returns true from the
  /// WatchdogParams::arm_misses-th in a row on
  bool OnMissedMessage() OSTEON_RT;
  /// A message with finite joints. @param X_WT  of its measured joints
  void OnMessage(const ArmState& state, const Pose& X_WT, rt::Nanoseconds now) OSTEON_RT;
  /// To be called at the end of a tick with a message: counts messages in a row in which the arm stood.
  void UpdateStandstill(const JointArray& q_meas) OSTEON_RT;

  /// The arm takes commands. One that is moved or braked (`moves`) must not have left COMMANDING_ACTIVE and
  /// come back unseen.
  [[nodiscard]] bool TakesCommands(const ArmState& state, bool moves) const OSTEON_RT;
  /// The arm has been in the same COMMANDING_ACTIVE since motion began: it is where it was last told to be,
  /// and its interpolator where commanding began.
  [[nodiscard]] bool IsSameActivation(const ArmState& state) const OSTEON_RT;
  /// The message's period is the loop's: each tick steps by it.
  [[nodiscard]] bool HasPeriod(const ArmState& state) const OSTEON_RT;
  /// The arm's program asks for the overlay that the law sends.
  [[nodiscard]] bool HasCommandMode(CommandMode mode) const OSTEON_RT;

  /// Motion begins in this activation.
  void StartCommanding(const ArmState& state) OSTEON_RT;
  /// The arm moves by itself.
  void StopCommanding() OSTEON_RT { commanded_ = false; }
  /// Rendering begins: the tool rests where it was measured last.
  void ResetTwist() OSTEON_RT { twist_.Reset(X_WT_); }

  /// That motion began with last.
  [[nodiscard]] std::uint32_t activation() const OSTEON_RT { return activation_; }
  /// The tool as measured in the last message.
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return X_WT_; }
  /// Its velocity, filtered: of T at To, in W.
  [[nodiscard]] const Twist& V_WT() const OSTEON_RT { return twist_.V(); }
  /// Between the last two messages, a multiple of the period [s].
  [[nodiscard]] double elapsed_s() const OSTEON_RT { return elapsed_s_; }
  /// The tick of the last message; 0: none yet.
  [[nodiscard]] rt::Nanoseconds measured_at() const OSTEON_RT { return measured_at_; }
  /// The arm has stood for kStandingMessages in a row.
  [[nodiscard]] bool stands() const OSTEON_RT { return standing_ == kStandingMessages; }

  static constexpr int kStandingMessages = 10;

 private:
  const ServoParams& params_;
  MeasuredTwist twist_;
  MessageGap message_gap_;
  Pose X_WT_{Pose::Identity()};
  rt::Nanoseconds measured_at_{0};
  double elapsed_s_{0.0};
  JointArray q_seen_{};  // [rad] measured in the message before
  int standing_{0}, missed_{0};
  std::uint32_t activation_{0};
  bool commanded_{false};  // motion began, and no message has said since that the arm left
};

/// The greatest distance of a joint of one array from the same of another [rad].
[[nodiscard]] double MaxJointDifference(const JointArray& a, const JointArray& b) OSTEON_RT;

}  // namespace osteon::control
