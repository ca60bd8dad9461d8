#pragma once

#include "base/marker.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/laws/impedance_renderer.h"
#include "control/loop/arm_session.h"
#include "control/loop/commanded_tool.h"
#include "control/loop/motion_supervisor.h"
#include "control/setup/servo_params.h"
#include "safety/acting_limits.h"
#include "safety/cell_state.h"

namespace osteon::control {

/// Applies events to the cell's state, and carries out the actions that hold or brake the command. Actions
/// that begin a motion are carried out by the caller.
class StateActions {
 public:
  /// The loop's parts that an event changes or a brake needs. References must outlive this object.
  struct Parts {
    const ServoParams& params;
    MotionSupervisor& supervisor;
    const ArmSession& session;
    CommandedTool& tool;
    const CouplingPipeline& coupling;
    ImpedanceRenderer& impedance;
  };
  explicit StateActions(const Parts& parts) : parts_(parts) {}

  /// Applies an event. If its action is to hold or to brake the command, begins that.
  /// @returns the action, for the caller to begin a motion
  safety::CellAction ApplyEvent(safety::CellEvent event) OSTEON_RT;
  /// Applies the event kFault, for a fault that is already latched.
  void ApplyFault() OSTEON_RT { ApplyEvent(safety::CellEvent::kFault); }
  /// Latches a fault and applies its event.
  void StopWith(safety::Fault fault) OSTEON_RT;
  /// Ends a stop. Call once the commanded motion is at rest, or in stop 0 once the arm stands still.
  void FinishStop() OSTEON_RT;

  /// One tick of braking by the law in use; ends the stop once the tool is at rest.
  /// @param reduced_speed  the arm is in operation mode T1 or reports no mode
  /// @param[in,out] acting  the limits that act are added
  void Brake(bool reduced_speed, safety::LimitSet& acting) OSTEON_RT;
  /// One tick of braking along the joints' last motion; ends the stop once they are at rest.
  void BrakeJoints() OSTEON_RT;

 private:
  Parts parts_;
};

}  // namespace osteon::control
