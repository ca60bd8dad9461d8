#pragma once

#include <memory>

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/laws/twist_parts.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "safety/acting_limits.h"
#include "safety/fault.h"
#include "safety/workspace.h"

namespace osteon::control {

/// Result of a step along the tool's twist.
struct FollowedTwist {
  /// kNone, or why nothing has moved: kInverseKinematics, kJointLimit.
  safety::Fault fault{safety::Fault::kNone};
  bool joints_limited{false};  ///< joints, reach or a singular posture took of the twist
  safety::LimitSet acting{};   ///< zones and elbow speed
};

/// Result of a tick of braking.
struct BrakingStep {
  safety::Fault fault{safety::Fault::kNone};  ///< found on the way; the joints are braked all the same
  bool at_rest{false};
  safety::LimitSet acting{};
};

/// The loop's command: the arm's joints, the tool's pose there, and the tool's velocity. Pose and joints
/// are one at every tick.
///
/// V_WT is the law's velocity of T at To, in W, and `share` of it moves the tool. With the impedance law V_WT
/// is the measured velocity while the loop renders, and the pose is the equilibrium of the arm's own spring.
class CommandedTool {
 public:
  CommandedTool(const ServoParams& params, std::unique_ptr<ArmFollower> arm);

  /// The arm moves by itself: what it commands itself is commanded. An idle arm need not say where it is.
  void ResetToArmPose(const ArmState& state) OSTEON_RT;
  /// The commanded joints stand.
  void HoldStill() OSTEON_RT;
  /// A stop begins: from here on V_WT is the velocity of the commanded tool itself.
  void StartBraking() OSTEON_RT;

  /// One tick along share × V_WT. What the arm did not do is taken from V_WT.
  /// @param max_elbow_speed_m_per_s > 0  @param elbow_moves  false: it is held on its circle
  [[nodiscard]] FollowedTwist Follow(double max_elbow_speed_m_per_s, bool elbow_moves) OSTEON_RT;

  /// One tick of braking along the tool's own direction, |v|² / 2a; where the tool's path has no joints,
  /// along the joints' own last motion.
  [[nodiscard]] BrakingStep Brake(double max_elbow_speed_m_per_s) OSTEON_RT;
  /// One tick of braking along the joints' last motion. @returns true at rest
  [[nodiscard]] bool BrakeJoints() OSTEON_RT;

  [[nodiscard]] ArmFollower& arm() OSTEON_RT { return *arm_; }
  [[nodiscard]] const ArmFollower& arm() const OSTEON_RT { return *arm_; }
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return arm_->X_WT(); }
  [[nodiscard]] const safety::Workspace& workspace() const OSTEON_RT { return workspace_; }
  /// The arm has said where it is.
  [[nodiscard]] bool has_pose() const OSTEON_RT { return has_pose_; }
  /// share × V_WT.
  [[nodiscard]] Twist Velocity() const OSTEON_RT { return Scaled(V_WT, share); }

  Twist V_WT;
  double share{0.0};

 private:
  const ServoParams& params_;
  std::unique_ptr<ArmFollower> arm_;
  safety::Workspace workspace_;
  bool has_pose_{false};
};

}  // namespace osteon::control
