#pragma once

#include "control/loop/motion_start.h"
#include "control/loop/state_actions.h"
#include "tests/control/loop/servo_parts.h"

namespace osteon::control {

/// The parts of a servo loop that start and end a motion, connected as in the loop. The law is the admittance
/// law.
struct StartRig {
  explicit StartRig(const ServoParams& p = ServoBench::Params()) : params(p) {}

  /// Handles one message of the standing arm, 1 ms after the previous message, and starts a motion if that is
  /// permitted.
  /// @returns whether rendering begins
  bool Tick() {
    now += rt::kMillisecond;
    readings.force.stamp = now;
    model.frame = 1;
    model.pose_stamp = now;
    session.OnMessage(state, ServoBench::StartPose(), now);
    takes_commands = start.UpdateSession(state);
    return start.StartIfPermitted({.state = state, .readings = readings, .model = model, .now = now},
                                  {.max_force_N = coupling.limiter().max_force_N(), .may_start = may_start});
  }

  ServoParams params;
  MotionSupervisor supervisor;
  ArmSession session{params};
  CommandedTool tool{params, Follower(params)};
  HandForce hand{params, ServoBench::FlangeToTool()};
  CouplingPipeline coupling{params};
  SafetyChecks checks{params, coupling.limiter().max_force_N()};
  ImpedanceRenderer impedance{params};
  StateActions actions{{.params = params,
                        .supervisor = supervisor,
                        .session = session,
                        .tool = tool,
                        .coupling = coupling,
                        .impedance = impedance}};
  MotionStart start{{.params = params,
                     .supervisor = supervisor,
                     .session = session,
                     .tool = tool,
                     .hand = hand,
                     .checks = checks,
                     .actions = actions}};

  ArmState state{StandingArm()};
  CellReadings readings;
  simulation::ContactModel model;
  rt::Nanoseconds now{rt::kSecond};
  bool may_start{true}, takes_commands{false};
};

}  // namespace osteon::control
