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

/// How an arm that the hand carries moves, and what of it is allowed.
struct ImpedanceMotion {
  Twist V_allowed_WT;  ///< within speed, zones and workspace: the tool is braked to it
  bool twist_limited{false}, workspace_limited{false};
  safety::FaultSet faults;  ///< too fast, outside, or where no command may put the joints
  safety::LimitSet acting;  ///< the zones of flange and elbow
};

/// A tick of the impedance law.
struct ImpedanceStep {
  safety::LimitedWrench rendered;  ///< of the coupling
  safety::LimitSet acting;
};

/// The impedance law: the arm carries itself and is where the hand has it, so that there is no commanded
/// pose. Coupling, speed and workspace count where the arm is measured. The wrench goes out as FRI's overlay
/// (on T, or as Jᵀ F); the joints' command, the equilibrium of the arm's own spring, goes along. Beyond the
/// tool's speed and at the workspace's bounds it is braked, at half as much again it stops.
class ImpedanceRenderer {
 public:
  /// @param params  of the loop, whose gains may change between ticks; must outlive this
  explicit ImpedanceRenderer(const ServoParams& params) : params_(params) {}

  /// The tool takes up rendering with these measured joints.
  void Reset(const JointArray& q_meas) OSTEON_RT;
  /// A stop begins.
  void StartBraking() OSTEON_RT { stop_ticks_ = 0; }
  /// A tick begins: a wrench counts for the tick that it was made in.
  void ClearWrench() OSTEON_RT { F_sent_T_W_ = {}; }

  /// The measured motion of this tick, and the arm's own spring led along with it.
  /// @param reduced_speed  the arm is in T1, or does not say
  [[nodiscard]] ImpedanceMotion FollowHand(const ArmSession& arm, const JointArray& q_meas,
                                           bool reduced_speed, CommandedTool& tool) OSTEON_RT;
  /// One tick, after CouplingPipeline::Evaluate at the measured pose and velocity and after FollowHand.
  /// @param V_before_WT  measured in the tick before
  [[nodiscard]] ImpedanceStep Step(const ArmSession& arm, const Twist& V_before_WT,
                                   const ImpedanceMotion& motion, CouplingPipeline& coupling,
                                   const CommandedTool& tool) OSTEON_RT;

  /// One tick of a stop: the arm's own spring holds it where it is now, and what still moves is braked for
  /// the stop's time. A hand that leads the tool on keeps the stop under way.
  /// @returns true once the tool is measured to stand
  [[nodiscard]] bool Brake(const ArmSession& arm, const safety::WrenchLimiter& limiter,
                           CommandedTool& tool) OSTEON_RT;

  /// Puts this tick's wrench into the command, by what the arm's program takes; zero where nothing was
  /// rendered.
  void FillWrenchOverlay(const ArmState& state, const Pose& X_WT_meas, const ArmFollower& arm,
                         ArmCommand& command) const OSTEON_RT;

 private:
  const ServoParams& params_;
  JointArray q_before_{};  // [rad] measured in the message before
  Wrench F_sent_T_W_;      // of this tick: coupling, damping and braking, within the limits
  StopBrake stop_brake_;
  int stop_ticks_{0};  // of a stop so far
};

}  // namespace osteon::control
