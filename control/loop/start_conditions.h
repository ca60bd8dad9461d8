#pragma once

#include "base/marker.h"
#include "control/arm/arm_follower.h"
#include "control/coupling/coupling_pipeline.h"
#include "control/loop/arm_session.h"
#include "control/loop/safety_checks.h"
#include "control/loop/tick_input.h"
#include "control/ports.h"
#include "control/setup/servo_params.h"
#include "safety/motion_permit.h"

namespace osteon::control {

/// Values that the conditions of motion depend on, beside a tick's inputs. References must outlive the call.
struct StartConditions {
  const ServoParams& params;
  const ArmSession& session;
  const SafetyChecks& checks;
  const ArmFollower& arm;
  double max_force_N{0.0};  ///< largest force that the coupling may render
  /// False while ServoLoop::AllowStart forbids motion, e.g. until the path to the start is checked.
  bool may_start{true};
  bool rendered{false};  ///< the loop has rendered before, so it does not move the arm to the start again
  bool bias_in_doubt{false};   ///< the sensor's bias is unknown: a hand may rest on the handle
  bool arm_overloaded{false};  ///< the external torques will soon exceed what the joints can hold
  /// Time of the last tick in which motion was not requested. Devices need some time to react to a new
  /// request: until then, their readings are from before it.
  rt::Nanoseconds withdrawn_at{kNeverWithdrawn};
  static constexpr rt::Nanoseconds kNeverWithdrawn{-rt::kSecond};
};

/// Evaluates the conditions of motion, in a tick with a message. A condition that would stop motion also
/// prevents its start.
[[nodiscard]] safety::MotionPermits EvaluatePermits(const TickInputs& tick,
                                                    const StartConditions& conditions) OSTEON_RT;

}  // namespace osteon::control
