#pragma once

#include <cstddef>
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

/// Result of moving the tool by one tick along a twist.
struct FollowedTwist {
  /// kInverseKinematics or kJointLimit if the joints could not follow; nothing has moved then.
  safety::Fault fault{safety::Fault::kNone};
  bool joints_limited{false};  ///< joint limits, reach or a singular posture reduced the motion
  safety::LimitSet acting{};   ///< limits kZones and kElbowSpeed, if they acted
};

/// Result of a tick of braking.
struct BrakingStep {
  /// as FollowedTwist::fault; the joints are then braked along their last motion
  safety::Fault fault{safety::Fault::kNone};
  bool at_rest{false};
  safety::LimitSet acting{};
};

/// The commanded state: joint positions, tool pose and tool velocity. The pose is always that of the
/// commanded joints.
///
/// With the admittance law, V_WT is the law's velocity of T at To, in W, and the tool moves with fade × V_WT.
/// With the impedance law, V_WT is the measured velocity while the loop renders, and the commanded joints are
/// the equilibrium of the arm's own spring.
class CommandedTool {
 public:
  CommandedTool(const ServoParams& params, std::unique_ptr<ArmFollower> arm);

  /// Sets the command to the position that the arm's own interpolator commands, or else to the measured one,
  /// at rest. Used while the loop does not command the arm. In an idle session the joints stay unchanged,
  /// because an idle arm may report no position.
  void ResetToArmPose(const ArmState& state) OSTEON_RT;
  /// Sets the commanded velocities to zero; the joints stay.
  void HoldStill() OSTEON_RT;
  /// Selects an entry of the table of tools. The joints stay unchanged; the pose becomes that of the tool, at
  /// rest.
  void SelectTool(std::size_t index) OSTEON_RT {
    HoldStill();
    arm_->SelectTool(index);
  }
  /// Begins a stop: V_WT becomes fade × V_WT, the velocity at which the tool moves, and fade becomes 1.
  void StartBraking() OSTEON_RT;

  /// Moves the tool by one tick along fade × V_WT. If the arm's limits reduce the motion, V_WT is reduced as
  /// well.
  /// @param max_elbow_speed_m_per_s > 0  @param elbow_moves  false: the arm angle is held
  [[nodiscard]] FollowedTwist FollowTwist(double max_elbow_speed_m_per_s, bool elbow_moves) OSTEON_RT;

  /// One tick of braking at constant deceleration a along the tool's twist: the tool stops within |v|² / 2a.
  /// If the joints cannot follow that path, they are braked along their own last motion (BrakeJoints).
  [[nodiscard]] BrakingStep Brake(double max_elbow_speed_m_per_s) OSTEON_RT;
  /// One tick of braking along the joints' last motion. @returns whether they are at rest
  [[nodiscard]] bool BrakeJoints() OSTEON_RT;

  [[nodiscard]] ArmFollower& arm() OSTEON_RT { return *arm_; }
  [[nodiscard]] const ArmFollower& arm() const OSTEON_RT { return *arm_; }
  [[nodiscard]] const Pose& X_WT() const OSTEON_RT { return arm_->X_WT(); }
  [[nodiscard]] const safety::Workspace& workspace() const OSTEON_RT { return workspace_; }
  /// Whether the arm has reported its position.
  [[nodiscard]] bool has_pose() const OSTEON_RT { return has_pose_; }
  /// Velocity at which the tool moves: fade × V_WT.
  [[nodiscard]] Twist Velocity() const OSTEON_RT { return Scaled(V_WT, fade); }

  Twist V_WT;
  double fade{0.0};

 private:
  const ServoParams& params_;
  std::unique_ptr<ArmFollower> arm_;
  safety::Workspace workspace_;
  bool has_pose_{false};
};

}  // namespace osteon::control
