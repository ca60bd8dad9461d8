#pragma once

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/loop/arm_session.h"
#include "control/loop/safety_checks.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "safety/motion_permit.h"
#include "simulation/contact/contact_model.h"

namespace osteon::control {

/// Inputs of a tick of the loop.
struct TickInputs {
  const ArmState& state;
  const CellReadings& readings;
  const simulation::ContactModel& model;
  rt::Nanoseconds now{0};
};

/// Inputs of the conditions of motion, beside a tick's inputs. Views must outlive the call.
struct StartConditions {
  const ServoParams& params;
  const ArmSession& session;
  const SafetyChecks& checks;
  const ArmFollower& arm;
  double max_force_N{0.0};     ///< that the coupling may render
  bool may_start{true};        ///< whoever checks the way to the start has not forbidden it
  bool rendered{false};        ///< at least once: there is no way to the start any more
  bool bias_in_doubt{false};   ///< a hand rests on the handle
  bool arm_overloaded{false};  ///< the arm's joints are about to bear more than they hold
};

/// The conditions of motion in a tick whose message came. A condition that would stop motion also prevents
/// its start.
[[nodiscard]] safety::MotionPermits EvaluatePermits(const TickInputs& tick,
                                                    const StartConditions& conditions) OSTEON_RT;

}  // namespace osteon::control
