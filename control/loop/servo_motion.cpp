// How ServoLoop's motion begins: the arm's session, the conditions of motion, the way to the start; and what
// is checked while nothing is rendered.

#include <algorithm>

#include "control/loop/servo_loop.h"

namespace osteon::control {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault;

// Updates the loop's view of the arm's session, and ends motion if the session ended. Returns true if the arm
// takes commands.
bool ServoLoop::UpdateSession(const ArmState& state) OSTEON_RT {
  const bool active = session_.TakesCommands(state, supervisor_.MovesOrBrakes());
  if (!active) {
    FollowArm(state);
    if (safety::Renders(this->state()) || this->state() == CellState::kStop2)
      supervisor_.Latch(Fault::kSession);
    ApplyEvent(CellEvent::kArmLeft);
  } else if (this->state() == CellState::kPaused ||
             (safety::Waits(this->state()) && (phase() != Phase::kStopped || !tool_.has_pose()))) {
    // if the arm is stopped before its first message, its first measured pose is held
    if (session_.IsSameActivation(state))
      tool_.HoldStill();
    else
      FollowArm(state);
  }
  if (supervisor_.stop_requested() && supervisor_.IsWaitingOrPaused()) ApplyEvent(CellEvent::kStopRequested);
  if (active && phase() != Phase::kStopped && !session_.HasPeriod(state)) {
    // the tool's speed is wrong if the arm's period differs from the loop's
    supervisor_.Latch(Fault::kPeriod);
    ApplyEvent(CellEvent::kArmLost);
  }
  if (active && phase() != Phase::kStopped && !session_.HasCommandMode(state.command_mode)) {
    supervisor_.Latch(Fault::kCommandMode);
    ApplyEvent(CellEvent::kArmLost);
  }
  return active;
}

// Sets the command to the pose that the arm itself commands. Used while the arm rests or moves by itself.
void ServoLoop::FollowArm(const ArmState& state) OSTEON_RT {
  tool_.ResetToArmPose(state);
  session_.StopCommanding();
  supervisor_.SetOnPath(false);
}

// Evaluates the conditions of motion. Once all hold, starts the path to the start, or rendering from the
// arm's present pose.
void ServoLoop::StartMotionIfPermitted(const TickInputs& tick) OSTEON_RT {
  const bool waits = supervisor_.IsWaiting(), rendered = supervisor_.rendered();
  const ForceReading& force = tick.readings.force;
  if (waits && !rendered && force.trusted &&
      safety::StampAge(tick.now, force.stamp) <= params_.watchdog.sensor_full_s)
    hand_.EstimateBias(force, session_.X_WT());
  if (waits || state() == CellState::kPaused || state() == CellState::kAligning)
    supervisor_.SetPermits(EvaluatePermits(tick, {.params = params_,
                                                  .session = session_,
                                                  .checks = checks_,
                                                  .arm = tool_.arm(),
                                                  .max_force_N = max_force_N(),
                                                  .may_start = requests_.may_start(),
                                                  .rendered = rendered,
                                                  .bias_in_doubt = hand_.bias_in_doubt(),
                                                  .arm_overloaded = arm_overloaded_,
                                                  .withdrawn_at = withdrawn_at_}));
  if (!waits) return;
  ApplyEvent(tick.state.session == SessionState::kIdle ? CellEvent::kArmIdle : CellEvent::kArmSeen);
  ApplyEvent(permits().AllButHandedOver() ? CellEvent::kPermitsHold : CellEvent::kPermitsMissing);
  if (!permits().All()) return;
  const bool there = rendered || tool_.arm().AtStart();
  const CellAction action = ApplyEvent(there ? CellEvent::kBeginRendering : CellEvent::kBeginAligning);
  if (action == CellAction::kBeginRendering) StartRendering(tick);
  if (action == CellAction::kBeginPath) StartPath(tick);
}

void ServoLoop::StartPath(const TickInputs& tick) OSTEON_RT {
  session_.StartCommanding(tick.state);
  supervisor_.SetOnPath(tool_.arm().BeginStartPath());
  checks_.OnMotionStarted(tick.now);
  hand_.ResetMotion(session_.X_WT());
  if (supervisor_.on_path()) return;
  // no path: the arm stands outside the range of positions that may be commanded
  supervisor_.Latch(Fault::kJointLimit);
  ApplyFault();
  FinishStop();
}

// Advances the path to the start by one step. The path is paused while the PLC withholds its permission,
// while a hand pushes against the arm, and during a stop. Rendering starts at the path's end.
void ServoLoop::StepStartPath(const TickInputs& tick) OSTEON_RT {
  const bool ends = safety::Brakes(state());
  const bool permitted = checks_.IsMotionPermitted(tick.readings.interlock, tick.now);
  const bool free = !params_.start || checks_.hand_N() <= params_.start->pause_force_N;
  const StartStep step = tool_.arm().StepToStart(permitted && free && !ends);
  if (step.refused != Fault::kNone) {
    supervisor_.Latch(step.refused);
    ApplyFault();
    FinishStop();
  } else if (ends && step.paused) {
    FinishStop();
  } else if (step.at_start && !ends && permits().All() &&
             ApplyEvent(CellEvent::kBeginRendering) == CellAction::kBeginRendering) {
    supervisor_.SetOnPath(false);
    StartRendering(tick);
  }
}

void ServoLoop::StartRendering(const TickInputs& tick) OSTEON_RT {
  session_.StartCommanding(tick.state);
  session_.ResetTwist();
  supervisor_.SetRendered();
  tool_.arm().StartFollowing();
  hand_.ResetMotion(session_.X_WT());
  coupling_.Reset();
  admittance_.Reset(tool_.X_WT());
  impedance_.Reset(tick.state.q_meas);
  checks_.OnRenderingStarted(tick.now);
}

// Checks the measured speed of the arm while the loop commands it. The path to the start has a speed limit of
// its own.
void ServoLoop::CheckArmSpeed(const ArmState& state, bool active) OSTEON_RT {
  const bool commanded = supervisor_.MovesOrBrakes() ||
                         (this->state() == CellState::kPaused && session_.IsSameActivation(state));
  if (!active || !commanded) {
    checks_.ResetArmSpeed();
    return;
  }
  const double limit_m_per_s = supervisor_.on_path() && params_.start
                                   ? params_.start->path.tool_speed_m_per_s
                                   : ToolSpeedLimit_m_per_s(params_, false);
  supervisor_.Latch(checks_.CheckArmSpeed(state, session_.X_WT().translation(), limit_m_per_s));
  result_.arm_speed_m_per_s = checks_.arm_speed_m_per_s();
  double& peak_m_per_s = statistics_.peak_measured_tool_speed_m_per_s;
  peak_m_per_s = std::max(peak_m_per_s, result_.arm_speed_m_per_s);
}

// Ends a motion if the arm is too far from its command, has stopped by itself, or has overloaded joints, or
// if a stop or a pause was requested.
void ServoLoop::CheckMotion(const ArmState& state) OSTEON_RT {
  const bool paused = this->state() == CellState::kPaused;
  if (!safety::IsMotion(this->state()) && this->state() != CellState::kStop2 &&
      !(paused && session_.IsSameActivation(state)))
    return;
  const double error_m = (session_.X_WT().translation() - tool_.X_WT().translation()).norm();
  statistics_.peak_tracking_error_m = std::max(statistics_.peak_tracking_error_m, error_m);
  // under the impedance law the arm is compliant: a hand may displace it while nothing is rendered
  const bool compliant = params_.law == Law::kImpedance && !safety::IsMotion(this->state());
  if (!compliant && !(error_m <= params_.max_tracking_error_m)) supervisor_.Latch(Fault::kTracking);
  if (state.safety_state != 0 && !paused) supervisor_.Latch(Fault::kSession);
  if (arm_overloaded_ && !paused) supervisor_.Latch(Fault::kJointLimit);
  if (faults().Any() && !safety::Renders(this->state()))
    ApplyFault();  // rendering checks more before it stops
  if (supervisor_.stop_requested()) ApplyEvent(CellEvent::kStopRequested);
  if (supervisor_.TakePauseRequest()) ApplyEvent(CellEvent::kPauseRequested);
}

// Checks sensor, spindle and hand on the path to the start. Nothing is rendered there, so the model's age is
// not checked; without the PLC's permission the path is paused (StepStartPath).
void ServoLoop::CheckOnPath(const TickInputs& tick) OSTEON_RT {
  const Wrench F_hand_T_W = ComputeHandWrench(tick.readings.force);
  supervisor_.Latch(checks_.CheckSensor(tick.readings.force, result_.ages.sensor_s, tick.now));
  supervisor_.Latch(checks_.CheckSpindle(tick.readings.spindle, tick.now));
  CheckHand(F_hand_T_W);
  if (faults().Any()) ApplyFault();
}

// Checks hand and sensor while the arm brakes to rest. Spindle and PLC are not checked: they are stopping as
// well.
void ServoLoop::CheckInStop(const TickInputs& tick) OSTEON_RT {
  const Wrench F_hand_T_W = ComputeHandWrench(tick.readings.force);
  supervisor_.Latch(checks_.CheckSensor(tick.readings.force, result_.ages.sensor_s, tick.now));
  CheckHand(F_hand_T_W);
}

void ServoLoop::CheckHand(const Wrench& F_hand_T_W) OSTEON_RT {
  supervisor_.Latch(checks_.CheckHand(F_hand_T_W));
  statistics_.peak_sensor_force_N = std::max(statistics_.peak_sensor_force_N, checks_.hand_N());
}

}  // namespace osteon::control
