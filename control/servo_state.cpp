// What ServoLoop is doing: its state by the cell's table, the conditions of motion, and how motion begins.

#include <algorithm>
#include <cmath>

#include "control/servo_loop.h"
#include "control/twist_parts.h"

namespace osteon::control {
namespace {

using safety::CellAction, safety::CellEvent, safety::CellState, safety::Fault, safety::MotionPermit;

// Beyond it an arm is not where its command is: lag at hand guiding's speeds is a fifth of it.
constexpr double kPlausible_rad = 0.1;
// Slower is standing: an encoder's step in a tick, not a coasting arm.
constexpr double kStands_rad_per_s = 0.02;
constexpr double kSamePeriod_s = 1e-6;

double FarthestJoint(const JointArray& a, const JointArray& b) OSTEON_RT {
  double most = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, std::abs(a[i] - b[i]));
  return most;
}

}  // namespace

Phase ServoLoop::phase() const OSTEON_RT {
  switch (state_) {
    case CellState::kOff:
      return stop_asked_ ? Phase::kStopped : Phase::kWaiting;
    case CellState::kChecking:
    case CellState::kReady:
    case CellState::kRecovery:
    case CellState::kPaused:
      return Phase::kWaiting;
    case CellState::kAligning:
      return Phase::kAligning;
    case CellState::kHaptic:
    case CellState::kCutting:
      return Phase::kHaptic;
    case CellState::kStop1:
    case CellState::kStop2:
      return on_path_ ? Phase::kAligning : Phase::kStopping;
    case CellState::kStop0:
    case CellState::kFault:
      break;
  }
  return Phase::kStopped;
}

bool ServoLoop::CanRecover() const OSTEON_RT {
  return !stop_asked_ && safety::Next(state_, CellEvent::kRecover).state == CellState::kRecovery &&
         safety::AllowsRecovery(faults_);
}

CellCommands ServoLoop::cell_commands() const OSTEON_RT {
  const bool ends = phase() == Phase::kStopped || state_ == CellState::kStop1;
  return {
      .motion_requested = !ends && !stop_asked_,
      .spindle_rad_per_s = safety::Renders(state_) && spindle_permitted_ && !depth_limit_.stops_spindle()
                               ? params_.spindle_rad_per_s
                               : 0.0,
      .quick_stop = ends && faults_.Any(),
      .clear_faults = !stop_asked_ && (state_ == CellState::kRecovery || (!moved_ && safety::Waits(state_)))};
}

// The one place where the state changes. What needs no more than the loop has is done here, what begins a
// motion by who calls.
CellAction ServoLoop::Take(CellEvent event) OSTEON_RT {
  const safety::CellTransition next = safety::Next(state_, event);
  state_ = next.state;
  moved_ = moved_ || safety::IsMotion(state_);
  switch (next.action) {
    case CellAction::kHold:
      V_WT_ = {};
      share_ = 0.0;
      on_path_ = false;
      arm_->Rest();
      break;
    case CellAction::kBrake:  // from here on V_WT_ is the velocity of the commanded tool itself
      V_WT_ = Scaled(V_WT_, share_);
      share_ = 1.0;
      stop_ticks_ = 0;
      break;
    case CellAction::kClearFaults:
      faults_.Clear();
      break;
    case CellAction::kGoOn:
    case CellAction::kFollowArm:
    case CellAction::kBeginPath:
    case CellAction::kBeginRendering:
      break;
  }
  return next.action;
}

// What was asked for from outside, as far as it does not end a motion: that comes in its place in the tick.
void ServoLoop::TakeRequests(const TickInput& input) OSTEON_RT {
  if (input.recover && CanRecover()) Take(CellEvent::kRecover);
  if (input.resume && !input.stop) Take(CellEvent::kResume);
  pause_asked_ = (pause_asked_ || input.pause) && (safety::Waits(state_) || safety::IsMotion(state_));
  if (!pause_asked_ || !safety::Waits(state_)) return;
  Take(CellEvent::kPauseAsked);
  pause_asked_ = false;
}

// What is commanded is at rest.
void ServoLoop::TakeRest() OSTEON_RT { Take(faults_.Any() ? CellEvent::kRestFault : CellEvent::kRest); }

// An arm that is not under control rests where it is measured to.
void ServoLoop::LookAtRest(const ArmState& state) OSTEON_RT {
  const bool stands = FarthestJoint(state.q_meas, q_seen_) <= kStands_rad_per_s * elapsed_s_;
  standing_ticks_ = stands ? std::min(standing_ticks_ + 1, kStandingTicks) : 0;
  q_seen_ = state.q_meas;
  if (state_ == CellState::kStop0 && standing_ticks_ == kStandingTicks) TakeRest();
}

// The arm has been in the same COMMANDING_ACTIVE since motion began: it is where it was last told to be, and
// its interpolator where commanding began.
bool ServoLoop::Commanded(const ArmState& state) const OSTEON_RT {
  return commanded_ && state.session == SessionState::kCommandingActive && state.activation == activation_;
}

bool ServoLoop::Permitted(const InterlockReading& interlock, rt::Nanoseconds now) const OSTEON_RT {
  return !params_.has_interlock ||
         (interlock.permitted && interlock.enabled &&
          safety::StampAge(now, interlock.stamp) <= params_.watchdog.interlock_stop_s);
}

// The conditions of motion. What would be a fault of a motion is none of its permissions.
safety::MotionPermits ServoLoop::Look(const ArmState& state, const CellReadings& readings,
                                      const simulation::ContactModel& model,
                                      rt::Nanoseconds now) const OSTEON_RT {
  const safety::WatchdogParams& most = params_.watchdog;
  safety::MotionPermits permits;
  permits.Put(MotionPermit::kArmFresh, true);  // nobody asks where there is no message
  permits.Put(MotionPermit::kHandedOver,
              state.session == SessionState::kCommandingActive && state.safety_state == 0);
  permits.Put(MotionPermit::kRunPermitted, Permitted(readings.interlock, now));
  permits.Put(MotionPermit::kSensorFresh,
              readings.force.trusted && safety::StampAge(now, readings.force.stamp) <= most.sensor_stop_s &&
                  Vector3(readings.force.F_S.f).stableNorm() <= sensor_trip_.level_N() &&
                  safety::IsFinite(readings.force.F_S));
  permits.Put(MotionPermit::kSpindleReady,
              !params_.has_spindle || (readings.spindle.ready && !readings.spindle.fault &&
                                       safety::StampAge(now, readings.spindle.stamp) <= most.spindle_stop_s));
  permits.Put(MotionPermit::kWayLookedAt, may_begin_.load(std::memory_order_relaxed));
  permits.Put(MotionPermit::kHandOff, rendered_ || !bias_.in_doubt());

  // the coupling as it would be in full: rendering begins with nothing of it
  CouplingState full;
  full.fade = 1.0;
  const CouplingOutput coupling =
      EvaluateCoupling(params_.coupling, model, arm_->X_WT(), {}, now, false, full);
  permits.Put(MotionPermit::kModelFresh,
              coupling.status == ModelStatus::kOk && coupling.age_s <= most.model_stop_s);
  const bool renders_here = rendered_ || arm_->AtStart();  // on the way to the start nothing is rendered
  permits.Put(MotionPermit::kNoResidualWrench,
              !overloaded_ && (!renders_here || coupling.F_T_W.f.norm() <= wrench_limiter_.max_force_N()));

  const double error_m = (X_WT_meas_.translation() - arm_->X_WT().translation()).norm();
  permits.Put(MotionPermit::kPosePlausible, error_m <= params_.max_tracking_error_m &&
                                                FarthestJoint(arm_->q(), state.q_meas) <= kPlausible_rad);
  return permits;
}

// What the arm's message decides. True where the arm takes commands.
bool ServoLoop::TakeSession(const ArmState& state) OSTEON_RT {
  // an arm that left and came back unseen is no more the one that was commanded
  const bool moved = safety::IsMotion(state_) || safety::Brakes(state_);
  const bool same = !moved || !commanded_ || state.activation == activation_;
  const bool active = state.session == SessionState::kCommandingActive && same;
  if (!active) {
    Mirror(state);
    if (safety::Renders(state_) || state_ == CellState::kStop2) faults_.Latch(Fault::kSession);
    Take(CellEvent::kArmLeft);
  } else if (state_ == CellState::kPaused ||
             (safety::Waits(state_) && (phase() != Phase::kStopped || !has_pose_))) {
    Wait(state);  // one that was to stop before it knew where the arm is holds it there
  }
  if (stop_asked_ && Rests()) Take(CellEvent::kStopAsked);
  if (active && phase() != Phase::kStopped &&
      !(std::abs(state.period_s - params_.period_s) < kSamePeriod_s)) {
    faults_.Latch(Fault::kPeriod);  // each tick steps by the loop's period: another one is another speed
    Take(CellEvent::kArmLost);
  }
  if (active && phase() != Phase::kStopped && !ModeFits(state.command_mode)) {
    faults_.Latch(Fault::kCommandMode);
    Take(CellEvent::kArmLost);
  }
  return active;
}

// The arm moves by itself and is followed, or it was not left since it was last commanded and is held.
void ServoLoop::Wait(const ArmState& state) OSTEON_RT {
  if (!Commanded(state)) {
    Mirror(state);
    return;
  }
  V_WT_ = {};
  share_ = 0.0;
  arm_->Rest();
}

// Motion, once everything permits it: to the start, or on from where the arm is.
void ServoLoop::Begin(const ArmState& state, rt::Nanoseconds now) OSTEON_RT {
  Take(state.session == SessionState::kIdle ? CellEvent::kArmIdle : CellEvent::kArmSeen);
  Take(permits_.InOrder() ? CellEvent::kInOrder : CellEvent::kNotInOrder);
  if (!permits_.All()) return;
  switch (Take(rendered_ || arm_->AtStart() ? CellEvent::kBeginThere : CellEvent::kBeginAway)) {
    case CellAction::kBeginRendering:
      StartRendering(state, now);
      break;
    case CellAction::kBeginPath:
      activation_ = state.activation;
      commanded_ = true;
      on_path_ = arm_->BeginStart();
      watchdog_.Start(now);
      spindle_trip_.Reset();
      flange_motion_ = {.X = X_WT_meas_ * X_TF_, .V = {}, .A = {}};
      if (on_path_) break;
      faults_.Latch(Fault::kJointLimit);  // the arm stands where no command may put it
      Take(CellEvent::kFault);
      TakeRest();
      break;
    default:
      break;
  }
}

// A step of the path. What stops stops the path's clock; what can not be commanded is not. A hand in the
// arm's way makes it rest on its path.
void ServoLoop::Align(const ArmState& state, bool permitted, rt::Nanoseconds now) OSTEON_RT {
  const bool ends = safety::Brakes(state_);
  const bool free = !params_.start || hand_N_ <= params_.start->pause_force_N;
  const StartStep step = arm_->StepToStart(permitted && free && !ends);
  if (step.refused != Fault::kNone) {
    faults_.Latch(step.refused);
    Take(CellEvent::kFault);
    TakeRest();
  } else if (ends && step.rests) {
    TakeRest();
  } else if (step.there && !ends && permits_.All() &&
             Take(CellEvent::kBeginThere) == CellAction::kBeginRendering) {
    on_path_ = false;
    StartRendering(state, now);
  }
}

void ServoLoop::StartRendering(const ArmState& state, rt::Nanoseconds now) OSTEON_RT {
  activation_ = state.activation;
  commanded_ = true;
  rendered_ = true;
  arm_->StartFollowing();
  measured_twist_.Reset(X_WT_meas_);
  q_meas_before_ = state.q_meas;
  flange_motion_ = {.X = X_WT_meas_ * X_TF_, .V = {}, .A = {}};
  coupling_ = {};
  pressed_ = false;
  axis_lock_.Reset(arm_->X_WT());
  vibration_.Reset();
  stabilisers_.Reset();
  mass_factor_ = 1.0;
  sight_age_s_ = 0.0;
  stop_ticks_ = 0;
  rate_trip_.Reset();
  stored_energy_limit_.Reset();
  force_limit_reaction_.Reset();
  depth_limit_.Reset();
  spindle_trip_.Reset();
  watchdog_.Start(now);
}

}  // namespace osteon::control
