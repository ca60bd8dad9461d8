#pragma once

#include "base/marker.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/motion_supervisor.h"
#include "control/loop/safety_checks.h"
#include "control/loop/start_conditions.h"
#include "control/loop/state_actions.h"
#include "control/loop/tick_input.h"
#include "control/sensing/hand_force.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// The values that a start of motion depends on, beside a tick's inputs and the loop's parts.
struct StartInput {
  // struct StartConditions describes the fields.
  double max_force_N{0.0};
  bool may_start{true};
  bool arm_overloaded{false};
  rt::Nanoseconds withdrawn_at{StartConditions::kNeverWithdrawn};
};

/// Begins motion: follows the arm's session, evaluates the conditions of motion, and moves the arm along the
/// path to the start.
///
/// In a tick with a message, call UpdateSession, then StartIfPermitted, then, while the supervisor is on the
/// path, StepPath. StartIfPermitted and StepPath return true in the tick in which rendering begins; the
/// caller then calls HapticRendering::Start.
class MotionStart {
 public:
  /// The loop's parts that a start changes. References must outlive this object.
  struct Parts {
    const ServoParams& params;
    MotionSupervisor& supervisor;
    ArmSession& session;
    CommandedTool& tool;
    HandForce& hand;
    SafetyChecks& checks;
    StateActions& actions;
  };
  explicit MotionStart(const Parts& parts) : parts_(parts) {}

  /// Updates command and state according to the arm's session. Ends motion if the arm has left
  /// COMMANDING_ACTIVE.
  /// @returns whether the arm takes commands
  [[nodiscard]] bool UpdateSession(const ArmState& state) OSTEON_RT;
  /// Evaluates the conditions of motion. Once all hold, begins the path to the start, or, if the arm is at
  /// the start or has rendered before, rendering from the arm's present pose.
  /// @returns whether rendering begins
  [[nodiscard]] bool StartIfPermitted(const TickInputs& tick, const StartInput& input) OSTEON_RT;
  /// Advances the path to the start by one step. The path is paused while the PLC withholds its permission,
  /// while a hand pushes against the arm, and during a stop.
  /// @returns whether rendering begins, at the path's end
  [[nodiscard]] bool StepPath(const TickInputs& tick) OSTEON_RT;

 private:
  void FollowArm(const ArmState& state) OSTEON_RT;
  void EstimateBias(const TickInputs& tick) OSTEON_RT;
  void StartPath(const TickInputs& tick) OSTEON_RT;

  Parts parts_;
};

}  // namespace osteon::control
