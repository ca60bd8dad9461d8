// How ServoLoop's motion begins: the arm's session, the conditions of motion, the way to the start; and what
// is checked while nothing is rendered.

#include <algorithm>

#include "control/loop/servo_loop.h"

namespace osteon::control {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault;

// Follows the arm's session. Returns true where the arm takes commands.
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
    supervisor_.Latch(Fault::kPeriod);  // each tick steps by the loop's period: another one is another speed
    ApplyEvent(CellEvent::kArmLost);
  }
  if (active && phase() != Phase::kStopped && !session_.HasCommandMode(state.command_mode)) {
    supervisor_.Latch(Fault::kCommandMode);
    ApplyEvent(CellEvent::kArmLost);
  }
  return active;
}

// The arm moves by itself, or rests: what it commands itself is commanded.
void ServoLoop::FollowArm(const ArmState& state) OSTEON_RT {
  tool_.ResetToArmPose(state);
  session_.StopCommanding();
  supervisor_.SetOnPath(false);
}

// Judges the conditions of motion, and begins it once all of them hold: to the start, or on from where the
// arm is.
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
                                                  .arm_overloaded = arm_overloaded_}));
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
  checks_.StartMotion(tick.now);
  hand_.ResetMotion(session_.X_WT());
  if (supervisor_.on_path()) return;
  supervisor_.Latch(Fault::kJointLimit);  // the arm stands where no command may put it
  ApplyFault();
  FinishStop();
}

// A step of the way to the start. Whatever stops the arm stops the path's clock. A hand in the arm's way
// makes it rest on its path.
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
  checks_.StartRendering(tick.now);
}

// How fast the arm is measured to be, as long as the loop is answerable for it. The way to the start has a
// speed of its own.
void ServoLoop::CheckArmSpeed(const ArmState& state, bool active, TickRecord& record) OSTEON_RT {
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
  record.tool_speed_meas_m_per_s = checks_.arm_speed_m_per_s();
  double& peak_m_per_s = statistics_.peak_measured_tool_speed_m_per_s;
  peak_m_per_s = std::max(peak_m_per_s, record.tool_speed_meas_m_per_s);
}

// Whether a motion must end: the arm is not where it is commanded, it has stopped itself, its joints bear too
// much, or an end was asked for.
void ServoLoop::CheckMotion(const ArmState& state) OSTEON_RT {
  const bool paused = this->state() == CellState::kPaused;
  if (!safety::IsMotion(this->state()) && this->state() != CellState::kStop2 &&
      !(paused && session_.IsSameActivation(state)))
    return;
  const double error_m = (session_.X_WT().translation() - tool_.X_WT().translation()).norm();
  statistics_.peak_tracking_error_m = std::max(statistics_.peak_tracking_error_m, error_m);
  // an arm that gives is displaced by whoever leans on it while nothing is rendered
  const bool gives = params_.law == Law::kImpedance && !safety::IsMotion(this->state());
  if (!gives && !(error_m <= params_.max_tracking_error_m)) supervisor_.Latch(Fault::kTracking);
  if (state.safety_state != 0 && !paused) supervisor_.Latch(Fault::kSession);
  if (arm_overloaded_ && !paused) supervisor_.Latch(Fault::kJointLimit);
  if (faults().Any() && !safety::Renders(this->state()))
    ApplyFault();  // rendering checks more before it stops
  if (supervisor_.stop_requested()) ApplyEvent(CellEvent::kStopRequested);
  if (supervisor_.TakePauseRequest()) ApplyEvent(CellEvent::kPauseRequested);
}

// On the way to the start nothing is rendered: the model's age does not count, and without the PLC's
// permission the arm rests on its path.
void ServoLoop::CheckOnPath(const TickInputs& tick, TickRecord& record) OSTEON_RT {
  const Wrench F_hand_T_W = ComputeHandWrench(tick.readings.force, record);
  supervisor_.Latch(checks_.CheckSensor(tick.readings.force, record.sensor_age_s, tick.now));
  supervisor_.Latch(checks_.CheckSpindle(tick.readings.spindle, tick.now));
  CheckHand(F_hand_T_W);
  if (faults().Any()) ApplyFault();
}

// While the arm brakes to rest, spindle and PLC have been told to end as well; hand and sensor go on.
void ServoLoop::CheckInStop(const TickInputs& tick, TickRecord& record) OSTEON_RT {
  const Wrench F_hand_T_W = ComputeHandWrench(tick.readings.force, record);
  supervisor_.Latch(checks_.CheckSensor(tick.readings.force, record.sensor_age_s, tick.now));
  CheckHand(F_hand_T_W);
}

void ServoLoop::CheckHand(const Wrench& F_hand_T_W) OSTEON_RT {
  supervisor_.Latch(checks_.CheckHand(F_hand_T_W));
  statistics_.peak_sensor_force_N = std::max(statistics_.peak_sensor_force_N, checks_.hand_N());
}

}  // namespace osteon::control
