#include "control/loop/start_conditions.h"

#include "control/coupling/virtual_coupling.h"

namespace osteon::control {
namespace {

using safety::MotionPermit;

// Beyond it an arm is not where its command is: lag at hand guiding's speeds is a fifth of it.
constexpr double kPlausible_rad = 0.1;
// Within it a PLC has answered a new request: its program's and the client's cycles, and the age at which a
// reading still counts.
constexpr rt::Nanoseconds kAnswered = 200 * rt::kMillisecond;

}  // namespace

safety::MotionPermits EvaluatePermits(const TickInputs& tick, const StartConditions& c) OSTEON_RT {
  const auto& [state, received, readings, model, now] = tick;
  safety::MotionPermits permits;
  permits.Set(MotionPermit::kArmFresh, true);  // nobody asks where there is no message
  permits.Set(MotionPermit::kHandedOver,
              state.session == SessionState::kCommandingActive && state.safety_state == 0);
  permits.Set(MotionPermit::kRunPermitted,
              now - c.withdrawn_at >= kAnswered && c.checks.IsMotionPermitted(readings.interlock, now));
  permits.Set(MotionPermit::kSensorFresh, c.checks.IsSensorReady(readings.force, now));
  permits.Set(MotionPermit::kSpindleReady, c.checks.IsSpindleReady(readings.spindle, now));
  permits.Set(MotionPermit::kPathChecked, c.may_start);
  permits.Set(MotionPermit::kHandOff, c.rendered || !c.bias_in_doubt);

  // the coupling as it would be in full: rendering begins with nothing of it
  CouplingState full;
  full.fade = 1.0;
  const CouplingOutput coupling =
      EvaluateCoupling(c.params.coupling, {.model = model, .X_WT = c.arm.X_WT(), .now = now}, full);
  permits.Set(MotionPermit::kModelFresh,
              coupling.status == ModelStatus::kOk && coupling.age_s <= c.params.watchdog.model_stop_s);
  const bool renders_here = c.rendered || c.arm.AtStart();  // on the way to the start nothing is rendered
  permits.Set(MotionPermit::kNoResidualWrench,
              !c.arm_overloaded && (!renders_here || coupling.F_T_W.f.norm() <= c.max_force_N));

  const double error_m = (c.session.X_WT().translation() - c.arm.X_WT().translation()).norm();
  permits.Set(MotionPermit::kPosePlausible,
              error_m <= c.params.max_tracking_error_m &&
                  MaxJointDifference(c.arm.q(), state.q_meas) <= kPlausible_rad);
  return permits;
}

}  // namespace osteon::control
