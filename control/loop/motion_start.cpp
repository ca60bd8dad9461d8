#include "control/loop/motion_start.h"

namespace osteon::control {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault;

bool MotionStart::UpdateSession(const ArmState& state) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions] = parts_;
  const bool active = session.TakesCommands(state, supervisor.MovesOrBrakes());
  if (!active) {
    FollowArm(state);
    if (safety::Renders(supervisor.state()) || supervisor.state() == CellState::kStop2)
      supervisor.Latch(Fault::kSession);
    actions.ApplyEvent(CellEvent::kArmLeft);
  } else if (supervisor.state() == CellState::kPaused ||
             (safety::Waits(supervisor.state()) &&
              (supervisor.phase() != Phase::kStopped || !tool.has_pose()))) {
    // If the loop was stopped before the arm's first message, the first reported pose becomes the command.
    if (session.IsSameActivation(state))
      tool.HoldStill();
    else
      FollowArm(state);
  }
  if (supervisor.stop_requested() && supervisor.IsWaitingOrPaused())
    actions.ApplyEvent(CellEvent::kStopRequested);
  if (active && supervisor.phase() != Phase::kStopped && !session.HasPeriod(state)) {
    // If the arm's period differs from the loop's, the tool would move at a wrong speed.
    supervisor.Latch(Fault::kPeriod);
    actions.ApplyEvent(CellEvent::kArmLost);
  }
  if (active && supervisor.phase() != Phase::kStopped && !session.HasCommandMode(state.command_mode)) {
    supervisor.Latch(Fault::kCommandMode);
    actions.ApplyEvent(CellEvent::kArmLost);
  }
  return active;
}

// Sets the command to the position that the arm's own interpolator commands. Used while the loop does not
// command the arm.
void MotionStart::FollowArm(const ArmState& state) OSTEON_RT {
  parts_.tool.ResetToArmPose(state);
  parts_.session.StopCommanding();
  parts_.supervisor.SetOnPath(false);
}

bool MotionStart::StartIfPermitted(const TickInputs& tick, const StartInput& input) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions] = parts_;
  const bool waits = supervisor.IsWaiting(), rendered = supervisor.rendered();
  if (waits && !rendered) EstimateBias(tick);
  const CellState state = supervisor.state();
  if (waits || state == CellState::kPaused || state == CellState::kAligning)
    supervisor.SetPermits(EvaluatePermits(tick, {.params = params,
                                                 .session = session,
                                                 .checks = checks,
                                                 .arm = tool.arm(),
                                                 .max_force_N = input.max_force_N,
                                                 .may_start = input.may_start,
                                                 .rendered = rendered,
                                                 .bias_in_doubt = hand.bias_in_doubt(),
                                                 .arm_overloaded = input.arm_overloaded,
                                                 .withdrawn_at = input.withdrawn_at}));
  if (!waits) return false;
  actions.ApplyEvent(tick.state.session == SessionState::kIdle ? CellEvent::kArmIdle : CellEvent::kArmSeen);
  actions.ApplyEvent(supervisor.permits().AllButHandedOver() ? CellEvent::kPermitsHold
                                                             : CellEvent::kPermitsMissing);
  if (!supervisor.permits().All()) return false;
  const bool at_start = rendered || tool.arm().AtStart();
  const CellAction action =
      actions.ApplyEvent(at_start ? CellEvent::kBeginRendering : CellEvent::kBeginAligning);
  if (action == CellAction::kBeginPath) StartPath(tick);
  return action == CellAction::kBeginRendering;
}

// Adds a recent reading to the estimate of the sensor's bias.
void MotionStart::EstimateBias(const TickInputs& tick) OSTEON_RT {
  const ForceReading& force = tick.readings.force;
  if (force.trusted && safety::StampAge(tick.now, force.stamp) <= parts_.params.watchdog.sensor_full_s)
    parts_.hand.EstimateBias(force, parts_.session.X_WT());
}

// Begins the path to the start, from the arm's present posture.
void MotionStart::StartPath(const TickInputs& tick) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions] = parts_;
  session.StartCommanding(tick.state);
  supervisor.SetOnPath(tool.arm().BeginStartPath());
  checks.OnMotionStarted(tick.now);
  hand.ResetMotion(session.X_WT());
  if (supervisor.on_path()) return;
  // There is no path, because the arm stands outside the range of positions that may be commanded.
  actions.StopWith(Fault::kJointLimit);
  actions.FinishStop();
}

bool MotionStart::StepPath(const TickInputs& tick) OSTEON_RT {
  const auto& [params, supervisor, session, tool, hand, checks, actions] = parts_;
  const bool stopping = safety::Brakes(supervisor.state());
  const bool permitted = checks.IsMotionPermitted(tick.readings.interlock, tick.now);
  const bool hand_is_free = !params.start || checks.hand_N() <= params.start->pause_force_N;
  const StartStep step = tool.arm().StepToStart(permitted && hand_is_free && !stopping);
  if (step.refused != Fault::kNone) {
    actions.StopWith(step.refused);
    actions.FinishStop();
  } else if (stopping && step.paused) {
    actions.FinishStop();
  } else if (step.at_start && !stopping && supervisor.permits().All() &&
             actions.ApplyEvent(CellEvent::kBeginRendering) == CellAction::kBeginRendering) {
    supervisor.SetOnPath(false);
    return true;
  }
  return false;
}

}  // namespace osteon::control
