#pragma once

#include "base/marker.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/motion_supervisor.h"
#include "control/loop/safety_checks.h"
#include "control/loop/servo_statistics.h"
#include "control/loop/state_actions.h"
#include "control/loop/tick_input.h"
#include "control/loop/tick_result.h"
#include "control/sensing/hand_force.h"
#include "control/setup/servo_params.h"

namespace osteon::control {

/// Runs the checks for the cell's present state while the arm moves or brakes. Latches the faults that they
/// find, and ends the motion. HapticRendering runs the checks that are needed only while rendering.
class MotionChecks {
 public:
  /// The loop's parts that are checked, and those that store the results. References must outlive this
  /// object.
  struct Parts {
    const ServoParams& params;
    MotionSupervisor& supervisor;
    const ArmSession& session;
    const CommandedTool& tool;
    HandForce& hand;
    SafetyChecks& checks;
    StateActions& actions;
    ServoStatistics& statistics;
    TickResult& result;
  };
  explicit MotionChecks(const Parts& parts) : parts_(parts) {}

  /// Checks the measured speed of the arm while the loop commands it. The path to the start has a speed limit
  /// of its own.
  /// @param active  whether the arm takes commands
  void CheckArmSpeed(const ArmState& state, bool active) OSTEON_RT;
  /// Ends a motion if the arm is too far from its command, has stopped by itself, or is about to overload its
  /// joints, or if a stop or a pause was requested.
  /// @param overloaded  whether the joints' load is about to exceed what they can hold
  void CheckMotion(const ArmState& state, bool overloaded) OSTEON_RT;
  /// Checks sensor, spindle and hand on the path to the start. Nothing is rendered there, so the model's age
  /// is not checked; without the PLC's permission the path is paused (MotionStart::StepPath).
  void CheckOnPath(const TickInputs& tick) OSTEON_RT;
  /// Checks hand and sensor while the arm brakes to rest. The drive and the PLC are not checked, because the
  /// spindle is being stopped and the request for motion is withdrawn.
  void CheckInStop(const TickInputs& tick) OSTEON_RT;
  /// Computes the hand's wrench on T at To, in W, and checks it. If it is finite, stores it in the tick's
  /// result.
  /// @returns the hand's wrench; zero if there is no valid reading
  Wrench MeasureHand(const ForceReading& reading) OSTEON_RT;

 private:
  Parts parts_;
};

}  // namespace osteon::control
