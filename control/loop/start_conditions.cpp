#include "control/loop/start_conditions.h"

#include "control/coupling/virtual_coupling.h"

namespace osteon::control {
namespace {

using safety::MotionPermit;

// Largest plausible difference of a joint from its command. At the speeds of hand guiding, the lag makes a
// fifth of this.
constexpr double kPlausible_rad = 0.1;
// Longest time until a reading of the PLC reflects a new request: the cycles of the PLC's program and of the
// client, plus the largest accepted age of a reading.
constexpr rt::Nanoseconds kAnswered = 200 * rt::kMillisecond;

}  // namespace

safety::MotionPermits EvaluatePermits(const TickInputs& tick, const StartConditions& c) OSTEON_RT {
  const auto& [state, received, readings, model, now] = tick;
  safety::MotionPermits permits;
  // always true: this function is called only in a tick with a message
  permits.Set(MotionPermit::kArmFresh, true);
  permits.Set(MotionPermit::kHandedOver,
              state.session == SessionState::kCommandingActive && state.safety_state == 0);
  permits.Set(MotionPermit::kRunPermitted,
              now - c.withdrawn_at >= kAnswered && c.checks.IsMotionPermitted(readings.interlock, now));
  permits.Set(MotionPermit::kSensorFresh, c.checks.IsSensorReady(readings.force, now));
  permits.Set(MotionPermit::kSpindleReady, c.checks.IsSpindleReady(readings.spindle, now));
  permits.Set(MotionPermit::kPathChecked, c.may_start);
  permits.Set(MotionPermit::kHandOff, c.rendered || !c.bias_in_doubt);

  // Evaluate the coupling without fade, although rendering will begin with the coupling faded out.
  CouplingState faded_in;
  faded_in.fade = 1.0;
  const CouplingOutput coupling =
      EvaluateCoupling(c.params.coupling, {.model = model, .X_WT = c.arm.X_WT(), .now = now}, faded_in);
  permits.Set(MotionPermit::kModelFresh,
              coupling.status == ModelStatus::kOk && coupling.age_s <= c.params.watchdog.model_stop_s);
  // otherwise the path to the start comes first, on which nothing is rendered
  const bool renders_here = c.rendered || c.arm.AtStart();
  permits.Set(MotionPermit::kNoResidualWrench,
              !c.arm_overloaded && (!renders_here || coupling.F_T_W.f.norm() <= c.max_force_N));

  const double error_m = (c.session.X_WT().translation() - c.arm.X_WT().translation()).norm();
  permits.Set(MotionPermit::kPosePlausible,
              error_m <= c.params.max_tracking_error_m &&
                  MaxJointDifference(c.arm.q(), state.q_meas) <= kPlausible_rad);
  return permits;
}

}  // namespace osteon::control
