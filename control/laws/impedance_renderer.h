#pragma once

#include "base/marker.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/stop_brake.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/setup/servo_params.h"
#include "safety/acting_limits.h"
#include "safety/fault.h"
#include "safety/workspace.h"

namespace osteon::control {

/// Limits on the measured motion of an arm that the hand moves.
struct ImpedanceMotion {
  Twist V_allowed_WT;  ///< part of the tool's twist within speed limit, zones and workspace
  bool twist_limited{false}, workspace_limited{false};
  safety::FaultSet faults;  ///< too fast, outside workspace or zones, or joints out of range
  safety::LimitSet acting;  ///< zones of flange and elbow, if they acted
};

/// Result of a tick of the impedance law.
struct ImpedanceStep {
  safety::LimitedWrench rendered;  ///< coupling wrench after its limits
  safety::LimitSet acting;         ///< limits that acted
};

/// Renders by the impedance law. The arm's own controller compensates the arm's weight, and the hand moves
/// the arm. There is no commanded pose: coupling, speed limit and workspace refer to the measured pose.
///
/// - The wrench is sent as FRI's overlay: as a wrench on T, or as joint torques Jᵀ F.
/// - The commanded joints are the equilibrium of the arm's own spring and follow the measured joints.
/// - Beyond the tool's speed limit and at the workspace's bounds, the tool is braked. At 1.5 times the speed
///   limit, or outside the workspace, the cell stops.
class ImpedanceRenderer {
 public:
  /// @param params  the loop's parameters; gains in them may change between ticks. Must outlive this object.
  explicit ImpedanceRenderer(const ServoParams& params) : params_(params) {}

  /// Call when rendering begins, with the measured joints.
  void Reset(const JointArray& q_meas) OSTEON_RT;
  /// Begins a stop.
  void StartBraking() OSTEON_RT { stop_ticks_ = 0; }
  /// Clears the wrench of the previous tick. Call at the beginning of each tick.
  void ClearWrench() OSTEON_RT { F_sent_T_W_ = {}; }

  /// Computes how much of the measured motion is allowed, and moves the equilibrium of the arm's own spring
  /// toward the measured joints.
  /// @param reduced_speed  the arm is in operation mode T1 or reports no mode
  [[nodiscard]] ImpedanceMotion FollowHand(const ArmSession& arm, const JointArray& q_meas,
                                           bool reduced_speed, CommandedTool& tool) OSTEON_RT;
  /// Computes the wrench of one tick. Call after CouplingPipeline::Evaluate at the measured pose and
  /// velocity, and after FollowHand.
  /// @param V_before_WT  velocity measured in the previous tick
  [[nodiscard]] ImpedanceStep Step(const ArmSession& arm, const Twist& V_before_WT,
                                   const ImpedanceMotion& motion, CouplingPipeline& coupling,
                                   const CommandedTool& tool) OSTEON_RT;

  /// One tick of a stop. The equilibrium of the arm's own spring stays where it is, and the remaining motion
  /// is braked for the duration of a joint stop. The stop lasts as long as a hand moves the tool.
  /// @returns true once by measurement, the tool stands still
  [[nodiscard]] bool Brake(const ArmSession& arm, const safety::WrenchLimiter& limiter,
                           CommandedTool& tool) OSTEON_RT;

  /// Writes this tick's wrench into the command, as a wrench or as joint torques, whichever command mode the
  /// arm's program requests. Writes zero if nothing was rendered.
  void FillWrenchOverlay(const ArmState& state, const Pose& X_WT_meas, const ArmFollower& arm,
                         ArmCommand& command) const OSTEON_RT;

 private:
  const ServoParams& params_;
  JointArray q_before_{};  // [rad] measured in the previous message
  Wrench F_sent_T_W_;      // wrench of this tick: coupling, damping and brake, limited
  StopBrake stop_brake_;
  int stop_ticks_{0};  // ticks of the present stop; when the tool moves after the braking, reset to the end
                       // of the braking
};

}  // namespace osteon::control
