#include "control/servo_loop.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "control/rt/prefetch.h"
#include "control/tick_input.h"
#include "control/tool_speed_trip.h"
#include "control/twist_parts.h"

namespace osteon::control {
namespace {

using safety::CellEvent, safety::CellState, safety::Fault;

constexpr double kMostOperatorTorque_Nm = 100.0;  // beyond it a reading counts as this much
constexpr double kSightMemory_s =
    0.1;  // many frames, or the speed limit would follow each one's age up and down
constexpr double kMaxPeriods = 10.0;  // between two messages, that a velocity is taken over
constexpr std::uint8_t kT1 = 0;       // ArmState::operation_mode
constexpr double kTurns = 0.05;       // of the wanted speed: below, a spindle counts as still

bool AllFinite(const JointArray& q) {
  return std::all_of(q.begin(), q.end(), [](double value) { return std::isfinite(value); });
}

void RequirePose(const Pose& X, const char* name) {
  const bool rotation = (X.linear() * X.linear().transpose() - Matrix3::Identity()).norm() < 1e-6 &&
                        X.linear().determinant() > 0.0;
  if (!X.matrix().allFinite() || !rotation)
    throw std::invalid_argument(std::string(name) + ": accepted a finite position and a rotation");
}

const ServoParams& Validated(const ServoParams& params, const Pose& X_WB, const Pose& X_FT) {
  Validate(params);
  RequirePose(X_WB, "X_WB");
  RequirePose(X_FT, "X_FT");
  return params;
}

}  // namespace

ServoLoop::ServoLoop(const ServoParams& params, const kinematics::LbrArm& arm, const Pose& X_WB,
                     const Pose& X_FT, double arm_angle_rad)
    : ServoLoop(params, MakeFollower(Validated(params, X_WB, X_FT), arm, X_WB, X_FT, arm_angle_rad), X_FT) {}

ServoLoop::ServoLoop(const ServoParams& params, const kinematics::OrthoParallelArm& arm, const Pose& X_WB,
                     const Pose& X_FT)
    : ServoLoop(params, MakeFollower(Validated(params, X_WB, X_FT), arm, X_WB, X_FT), X_FT) {}

ServoLoop::ServoLoop(const ServoParams& params, std::unique_ptr<ArmFollower> arm, const Pose& X_FT)
    : params_(params),
      arm_(std::move(arm)),
      X_TF_(X_FT.inverse()),
      wrench_limiter_(params.wrench),
      rate_trip_(params.coupling.max_stiffness_N_per_m, params.twist.max_speed_m_per_s),
      sensor_trip_(params.sensor_force, wrench_limiter_.max_force_N()),
      workspace_(WorkspaceOf(params)),
      depth_limit_(params.depth),
      stored_energy_limit_(params.energy.max_stored_J),
      force_limit_reaction_(params.on_force_limit, params.stop_deceleration_m_per_s2, params.period_s),
      spindle_trip_(params.spindle_limits),
      watchdog_(params.watchdog),
      arm_speed_(ArmSpeedParams{}, params.period_s),
      bias_(params.law == Law::kAdmittance ? CreepBound(params.sensor_bias, params.admittance)
                                           : params.sensor_bias,
            params.sensor, params.period_s),
      vibration_(params.vibration, params.period_s),
      stabilisers_(params.stabilisers, LawOf(params), params.period_s),
      axis_lock_(params.admittance, params.period_s),
      most_stiffness_N_per_m_(params.coupling.max_stiffness_N_per_m),
      gain_ramp_(GainsOf(params.admittance, params.coupling), params.period_s),
      measured_twist_(params.impedance.twist_filter_s) {
  wrench_limiter_.Cap(ForceLimit_N(params));
}

simulation::ToolCommand ServoLoop::tool_command() const OSTEON_RT {
  const bool renders = safety::Renders(state_), gives = params_.law == Law::kImpedance && renders;
  return {.X_WT = gives ? X_WT_meas_ : arm_->X_WT(),
          .spindle_rad_per_s = renders ? spindle_rad_per_s_ : 0.0,
          .stamp = !has_pose_ ? 0
                   : gives    ? measured_at_
                              : now_};
}

TickRecord ServoLoop::Tick(const ArmState& state, ReceiveResult received, const CellReadings& readings,
                           const simulation::ContactModel& model, rt::Nanoseconds now,
                           ArmCommand& command) OSTEON_RT {
  now_ = now;
  acting_ = {};
  reduced_ = state.operation_mode == kT1;
  TickRecord record;
  record.tick = tick_++;
  record.stamp = received == ReceiveResult::kOk ? state.stamp : now;
  record.session_state = static_cast<std::uint8_t>(state.session);
  record.model_frame = model.frame;
  record.model_age_s = model.frame == 0 ? safety::kNoAge_s : safety::AgeSeconds(now, model.pose_stamp);
  record.sensor_age_s = safety::StampAge(now, readings.force.stamp);
  stop_asked_ = stop_requested_.load(std::memory_order_relaxed);
  record.input = InputOf(state, received, readings, model, now, stop_asked_);
  record.input.recover = recovery_requested_.exchange(false, std::memory_order_relaxed);
  record.input.pause = pause_requested_.exchange(false, std::memory_order_relaxed);
  record.input.resume = resume_requested_.exchange(false, std::memory_order_relaxed);
  StepGains(record.input);
  TakeRequests(record.input);
  record.input.repeat_differed = std::exchange(differed_, false);
  if (record.input.repeat_differed) {
    faults_.Latch(Fault::kRepeatDiffers);
    Take(CellEvent::kFault);
  }
  record.input.recorder_stalled = std::exchange(recorder_stalled_, false);
  if (record.input.recorder_stalled) {
    faults_.Latch(Fault::kRecorder);
    Take(CellEvent::kFault);
  }

  F_sent_T_W_ = {};  // a wrench counts for the tick that it was made in
  record.q_meas = state.q_meas;
  if (received != ReceiveResult::kOk) {
    Miss(received);
    if (stop_asked_ && Rests()) Take(CellEvent::kStopAsked);
  } else if (!AllFinite(state.q_meas) || (state.has_ipo && !AllFinite(state.q_ipo))) {
    faults_.Latch(Fault::kNotFinite);  // hold this tick: a position that is not known can not be left
    permits_ = {};
    // as good as no message: what can not be braked for long is held for good
    Take(watchdog_.MissArm() ? CellEvent::kArmLost : CellEvent::kFault);
  } else {
    watchdog_.MeetArm();
    MeasureMotion(state);
    Answer(state, readings, model, now, record);
  }

  statistics_.limits.Count(acting_);
  record.limits = acting_.bits();
  command.q = arm_->q();
  command.activation = activation_;
  PutWrench(state, command);
  record.phase = phase();
  record.cell_state = static_cast<std::uint8_t>(state_);
  record.permits = permits_.bits();
  record.faults = faults_.bits();
  record.q_cmd = command.q;
  record.activation_cmd = command.activation;
  record.F_cmd_T = command.F;
  record.tau_cmd = command.tau;
  record.X_WT_cmd = arm_->X_WT();
  record.X_WT_meas = X_WT_meas_;
  record.v_WT_cmd_m_per_s = Vector3(share_ * V_WT_.v);
  record.spindle_rad_per_s = tool_command().spindle_rad_per_s;
  record.F_bias_S = bias_.bias();
  return record;
}

void ServoLoop::Prefetch() const OSTEON_RT {
  rt::Prefetch(*this);
  arm_->Prefetch();
}

// Where the arm is and how it moves, by its messages: the time between two of them is known by what was lost.
void ServoLoop::MeasureMotion(const ArmState& state) OSTEON_RT {
  X_WT_meas_ = arm_->ToolPose(state.q_meas);
  if (measured_at_ == 0) {
    measured_twist_.Reset(X_WT_meas_);
    q_seen_ = state.q_meas;
  }
  elapsed_s_ = std::min(message_gap_.Step(state), kMaxPeriods) * params_.period_s;
  measured_at_ = now_;
  measured_twist_.Step(X_WT_meas_, elapsed_s_);
}

// A tick whose message came and can be believed: what it says of the arm, what is asked for, what is done.
void ServoLoop::Answer(const ArmState& state, const CellReadings& readings,
                       const simulation::ContactModel& model, rt::Nanoseconds now,
                       TickRecord& record) OSTEON_RT {
  const bool active = TakeSession(state);
  overloaded_ = arm_->TakeTorques(state.tau_ext);
  if (!AllFinite(state.tau_ext)) {  // the trip on them can't be counted on
    faults_.Latch(Fault::kNotFinite);
    Take(CellEvent::kFault);
  }
  WatchArmSpeed(state, active, record);

  // may it begin?
  const bool waits = safety::Waits(state_) && phase() != Phase::kStopped;
  if (waits && !rendered_ && readings.force.trusted && record.sensor_age_s <= params_.watchdog.sensor_full_s)
    bias_.Rest(readings.force.F_S, X_WT_meas_ * X_TF_);
  if (waits || state_ == CellState::kPaused || state_ == CellState::kAligning)
    permits_ = Look(state, readings, model, now);
  if (waits) Begin(state, now);

  // must it end?
  if (safety::IsMotion(state_) || state_ == CellState::kStop2 ||
      (state_ == CellState::kPaused && Commanded(state))) {
    const double error_m = (X_WT_meas_.translation() - arm_->X_WT().translation()).norm();
    statistics_.peak_tracking_error_m = std::max(statistics_.peak_tracking_error_m, error_m);
    // an arm that gives is displaced by whoever leans on it while nothing is rendered
    const bool gives = params_.law == Law::kImpedance && !safety::IsMotion(state_);
    if (!gives && !(error_m <= params_.max_tracking_error_m)) faults_.Latch(Fault::kTracking);
    if (state.safety_state != 0 && state_ != CellState::kPaused) faults_.Latch(Fault::kSession);
    if (overloaded_ && state_ != CellState::kPaused) faults_.Latch(Fault::kJointLimit);
    if (faults_.Any() && !safety::Renders(state_)) Take(CellEvent::kFault);  // who renders looks further
    if (stop_asked_) Take(CellEvent::kStopAsked);
    if (pause_asked_) Take(CellEvent::kPauseAsked);
    pause_asked_ = false;
  }
  if (state_ == CellState::kAligning) SuperviseStartPath(readings, now, record);
  if (state_ == CellState::kStop1) SuperviseStop(readings, now, record);
  if (on_path_) Align(state, Permitted(readings.interlock, now), now);

  const bool waited = phase() == Phase::kWaiting || phase() == Phase::kAligning;
  if (active && !waited) ++statistics_.active_ticks;
  if (safety::Renders(state_) && params_.law == Law::kImpedance)
    RenderImpedance(readings, model, now, record);
  else if (safety::Renders(state_))
    Render(readings, model, now, record);
  else if (state_ == CellState::kStop2)
    BrakeForPause(readings, model, now, record);
  else if (state_ == CellState::kStop1 && !on_path_)
    Brake();
  LookAtRest(state);
}

// The arm moves by itself, or rests: commanded is what it commands itself. An idle one need not say where it
// is.
void ServoLoop::Mirror(const ArmState& state) OSTEON_RT {
  V_WT_ = {};
  share_ = 0.0;
  arm_->Rest();
  commanded_ = on_path_ = false;
  if (state.session == SessionState::kIdle) return;
  arm_->Put(state.has_ipo ? state.q_ipo : state.q_meas);
  has_pose_ = true;
}

// No message, so nothing can be answered: the arm holds the last command, and so does the virtual tool.
void ServoLoop::Miss(ReceiveResult received) OSTEON_RT {
  permits_ = {};
  if (safety::Waits(state_) && received == ReceiveResult::kTimeout) return;  // the arm may still be booting
  ++statistics_.missed_messages;
  if (!watchdog_.MissArm() && received == ReceiveResult::kTimeout) return;
  if (phase() == Phase::kStopped) return;
  faults_.Latch(Fault::kArmStale);
  Take(CellEvent::kArmLost);
}

void ServoLoop::TakeSpindle(const CellReadings& readings) OSTEON_RT {
  spindle_permitted_ = !params_.has_interlock || readings.interlock.spindle_permitted;
  const double wanted = cell_commands().spindle_rad_per_s;
  const double speed = params_.has_spindle ? readings.spindle.speed_rad_per_s : wanted;
  // a positive turn is what the tool's edges are ground for
  spindle_rad_per_s_ = std::isfinite(speed) && speed > kTurns * params_.spindle_rad_per_s ? speed : 0.0;
  Take(spindle_rad_per_s_ > 0.0 ? CellEvent::kSpindleTurns : CellEvent::kSpindleStill);
}

// What the hand exerts on T at To, in W; zero where no reading is to be trusted.
Wrench ServoLoop::TakeSensor(const CellReadings& readings, TickRecord& record) OSTEON_RT {
  Wrench F_operator_T_W;
  const double inertia_share = params_.sensor.inertia_share;
  if (inertia_share > 0.0) {
    StepMotion(X_WT_meas_ * X_TF_, params_.sensor.acceleration_hz, elapsed_s_, flange_motion_);
  }
  if (record.sensor_age_s < safety::kNoAge_s && readings.force.trusted) {
    Wrench F_S = readings.force.F_S;
    F_S.f -= bias_.bias().f;
    F_S.t -= bias_.bias().t;
    F_operator_T_W = HandWrench(params_.sensor, F_S, X_WT_meas_ * X_TF_, X_WT_meas_.translation());
    if (inertia_share > 0.0) {
      const Wrench inertia = InertiaWrench(params_.sensor, flange_motion_, X_WT_meas_.translation());
      F_operator_T_W.f += inertia_share * inertia.f;
      F_operator_T_W.t += inertia_share * inertia.t;
    }
  }
  if (safety::IsFinite(F_operator_T_W)) record.F_operator_T_W = F_operator_T_W;
  return F_operator_T_W;
}

void ServoLoop::Render(const CellReadings& readings, const simulation::ContactModel& model,
                       rt::Nanoseconds now, TickRecord& record) OSTEON_RT {
  const double dt_s = params_.period_s;
  const Pose X_before = arm_->X_WT();
  TakeSpindle(readings);

  const Wrench F_operator_T_W = TakeSensor(readings, record);
  const double sensor_share = watchdog_.SensorShare(record.sensor_age_s);

  // the bone
  const Twist V_before_WT = Scaled(V_WT_, share_);
  const CouplingOutput coupling = EvaluateCoupling(params_.coupling, model, X_before, V_before_WT, now,
                                                   spindle_rad_per_s_ > 0.0, coupling_);
  record.model_age_s = coupling.age_s;
  pressed_ = !coupling.displacement_W.isZero(0.0);
  const safety::LimitedWrench limited = LimitCoupling(coupling, X_before, V_before_WT);
  force_limit_reaction_.Step({.displacement_W = coupling.displacement_W,
                              .rendered_share = limited.share,
                              .advance_m_per_s = spindle_rad_per_s_ > 0.0 ? model.advance_m_per_s : 0.0});
  record.tool_in_bone_m = force_limit_reaction_.tool_in_bone_m();
  if (!safety::IsFinite(coupling.F_T_W)) faults_.Latch(Fault::kNotFinite);

  Supervise(coupling, F_operator_T_W, record.sensor_age_s, readings, now);
  PutWrenchStep(record);
  if (faults_.Any()) {
    record.F_coupling_T_W = limited.F;
    Take(CellEvent::kFault);
    Brake();
    return;
  }

  // the law: the model's age slows the operator's force and the motion as it fades the coupling
  const Wrench F_hand_T_W =
      PastDeadZone(params_.admittance,
                   safety::ScaleWrench(F_operator_T_W, sensor_trip_.level_N(), kMostOperatorTorque_Nm).F);
  const double hand = coupling.fade * sensor_share;
  safety::LimitedWrench rendered = LimitRenderedWrench(
      stabilisers_.Calm(coupling, X_before, V_before_WT, limited, wrench_limiter_),
      depth_limit_.Step(X_before.translation(), V_before_WT.v, params_.coupling.max_stiffness_N_per_m),
      coupling.fade);
  // a virtual tool that vibrates in the hand is heavier, and more damped
  record.vibration_index = vibration_.Step(F_operator_T_W, spindle_rad_per_s_);
  record.vibration_reference_N = vibration_.reference_N();
  V_WT_ = AfterMassChange(V_WT_, vibration_.mass_factor() / mass_factor_);
  mass_factor_ = vibration_.mass_factor();
  const AdmittanceParams law = Times(params_.admittance, mass_factor_,
                                     std::max(vibration_.damping_factor(), stabilisers_.damping_factor()));
  const Twist V_locked_C = axis_lock_.Correction(X_before);
  const auto next_twist = [&](double coupling_share, Twist& V_WT) OSTEON_RT {
    const Wrench F_T_W{.f = hand * F_hand_T_W.f + coupling_share * rendered.F.f,
                       .t = hand * F_hand_T_W.t + coupling_share * rendered.F.t};
    return NextTwist(law, X_before, V_WT_, F_T_W, dt_s, V_WT, V_locked_C);
  };
  Twist V_next_WT;
  bool finite = next_twist(1.0, V_next_WT);
  // power of the motion that the wrench itself makes: the law is affine in it
  if (finite && coupling.fade * Power(rendered.F, V_next_WT) > params_.energy.max_power_W) {
    Twist V_free_WT;
    finite = next_twist(0.0, V_free_WT);
    const double max_power_W = params_.energy.max_power_W / coupling.fade;  // the tool moves by fade × V
    LimitPower(safety::PowerShare(Power(rendered.F, V_free_WT), Power(rendered.F, V_next_WT), max_power_W),
               rendered);
    finite = finite && next_twist(1.0, V_next_WT);
  }
  if (!finite) {
    faults_.Latch(Fault::kNotFinite);
    Take(CellEvent::kFault);
    Brake();
    return;
  }
  const Wrench& F_coupling_T_W = rendered.F;
  record.F_coupling_T_W = F_coupling_T_W;
  stabilisers_.Put(record);
  record.wrench_scale = std::min(limited.share, rendered.share);
  record.arm_share = std::min(limited.arm_share, rendered.arm_share);
  record.mass_factor = mass_factor_;
  record.damping_factor = vibration_.damping_factor();

  // speed: of the cell, and by how far the tool gets before a frame tells what is there; slower no harder
  // than a stop, so that a simulation that stalls while the tool flies is outrun (the model's age then holds
  // the tool)
  safety::TwistLimitParams most = params_.twist;
  most.max_speed_m_per_s = ToolSpeedLimit_m_per_s(params_, reduced_);
  sight_age_s_ = std::max(std::min(coupling.age_s, params_.coupling.gone_s),
                          (1.0 - dt_s / kSightMemory_s) * sight_age_s_);
  const double sight_m_per_s = params_.model_sight_m / std::max(sight_age_s_, dt_s);
  const double braked_m_per_s = V_WT_.v.norm() - params_.stop_deceleration_m_per_s2 * dt_s;
  most.max_speed_m_per_s = std::min(most.max_speed_m_per_s, std::max(sight_m_per_s, braked_m_per_s));
  safety::LimitedTwist slow = safety::LimitTwist(V_next_WT, most);
  acting_.Add(safety::Limit::kBoneEntry, force_limit_reaction_.Limit(V_WT_.v, slow.V.v));
  const safety::Workspace::Result inside = workspace_.Limit(X_before.translation(), slow.V.v, dt_s);
  V_WT_ = {.v = inside.v_WT, .w = slow.V.w};
  if (inside.acted && axis_lock_.any()) {  // it does not slide along: that could leave its line
    // the share of v that has no more than the bound's part of it: 1 - |removed|^2 / (v . removed)
    const Vector3 removed = slow.V.v - inside.v_WT;
    const double along = slow.V.v.dot(removed);
    const double share = along > 0.0 ? std::max(0.0, 1.0 - removed.squaredNorm() / along) : 0.0;
    V_WT_ = Scaled(slow.V, share);
    V_WT_.v = workspace_.Limit(X_before.translation(), V_WT_.v, dt_s).v_WT;
  }
  share_ = coupling.fade;

  // the joints
  bool joints_limited = false;
  if (!Follow(joints_limited)) {
    Take(CellEvent::kFault);
    BrakeJoints();
  }
  const Pose& X_WT = arm_->X_WT();

  // what came out
  const double speed_m_per_s = (X_WT.translation() - X_before.translation()).norm() / dt_s;
  if (speed_m_per_s > ToolSpeedTrip_m_per_s(params_)) faults_.Latch(Fault::kToolSpeed);
  if (workspace_.Violated(X_WT.translation())) faults_.Latch(Fault::kWorkspace);
  if (faults_.Any()) Take(CellEvent::kFault);

  statistics_.peak_power_W =
      std::max(statistics_.peak_power_W, Power(F_coupling_T_W, SmallStep(X_before, X_WT)) / dt_s);
  CountRendered({.F = rendered.F, .share = record.wrench_scale, .arm_share = record.arm_share}, speed_m_per_s,
                slow.share < 1.0, inside.acted, coupling.fade, sensor_share);
  acting_.Add(safety::Limit::kJoints, joints_limited);
}

// Moves the arm along the law's twist, and takes from the twist what the arm did not do. False, with the
// fault latched and nothing moved, where the joints are not known.
bool ServoLoop::Follow(bool& limited) OSTEON_RT {
  const Twist V_WT = Scaled(V_WT_, share_);
  const Followed followed =
      arm_->Follow({.V_WT = V_WT,
                    .elbow_share = share_,
                    .max_elbow_speed_m_per_s = ElbowSpeedLimit_m_per_s(params_, reduced_),
                    .elbow_moves = safety::Renders(state_)});
  if (followed.fault != Fault::kNone) {
    faults_.Latch(followed.fault);
    return false;
  }
  limited = followed.limited;
  acting_.Add(safety::Limit::kZones, followed.zone_acted);
  acting_.Add(safety::Limit::kElbowSpeed, followed.elbow_acted);
  if (limited || followed.zone_acted || followed.elbow_acted) {
    // the law goes on from what the tool does; as the model's age fades the motion, so its reaction
    V_WT_.v += share_ * (followed.V_WT.v - V_WT.v);
    V_WT_.w += share_ * (followed.V_WT.w - V_WT.w);
  }
  return true;
}

void ServoLoop::Supervise(const CouplingOutput& coupling, const Wrench& F_operator_T_W, double sensor_age_s,
                          const CellReadings& readings, rt::Nanoseconds now) OSTEON_RT {
  SuperviseDevices(coupling.age_s, sensor_age_s, readings, now);
  if (coupling.status == ModelStatus::kDeviceLost) faults_.Latch(Fault::kDevice);
  if (coupling.status == ModelStatus::kNotCredible) faults_.Latch(Fault::kNotFinite);
  if (rate_trip_.Check(coupling.F_T_W.f, CouplingStep_s())) faults_.Latch(Fault::kWrenchRate);
  statistics_.peak_tool_in_bone_m =
      std::max(statistics_.peak_tool_in_bone_m, force_limit_reaction_.tool_in_bone_m());
  if (force_limit_reaction_.too_deep()) faults_.Latch(Fault::kToolInBone);
  if (force_limit_reaction_.must_stop()) faults_.Latch(Fault::kForceLimit);
  SuperviseHand(F_operator_T_W);
}

// On the way to the start, where nothing is rendered: the model's age does not count, and without the PLC's
// permission the arm rests on its path.
void ServoLoop::SuperviseStartPath(const CellReadings& readings, rt::Nanoseconds now,
                                   TickRecord& record) OSTEON_RT {
  const Wrench F_operator_T_W = TakeSensor(readings, record);
  SuperviseSensor(record.sensor_age_s, readings, now);
  SuperviseSpindle(readings, now);
  SuperviseHand(F_operator_T_W);
  if (faults_.Any()) Take(CellEvent::kFault);
}

// While it brakes to rest: spindle and PLC have been told to end as well, hand and sensor go on.
void ServoLoop::SuperviseStop(const CellReadings& readings, rt::Nanoseconds now,
                              TickRecord& record) OSTEON_RT {
  const Wrench F_operator_T_W = TakeSensor(readings, record);
  SuperviseSensor(record.sensor_age_s, readings, now);
  SuperviseHand(F_operator_T_W);
}

void ServoLoop::SuperviseSensor(double sensor_age_s, const CellReadings& readings,
                                rt::Nanoseconds now) OSTEON_RT {
  faults_.Latch(watchdog_.Check(now, {.sensor_s = sensor_age_s}));
  if (!readings.force.trusted) faults_.Latch(Fault::kSensorFault);
}

void ServoLoop::SuperviseSpindle(const CellReadings& readings, rt::Nanoseconds now) OSTEON_RT {
  if (!params_.has_spindle) return;
  faults_.Latch(watchdog_.Check(now, {.spindle_s = safety::StampAge(now, readings.spindle.stamp)}));
  if (!readings.spindle.ready || readings.spindle.fault) faults_.Latch(Fault::kSpindle);
  if (spindle_trip_.Check(readings.spindle.torque_Nm, readings.spindle.speed_rad_per_s, params_.period_s))
    faults_.Latch(Fault::kSpindleLimit);
}

// What the trip on the wrench's rate found in this tick, and what it accepts.
void ServoLoop::PutWrenchStep(TickRecord& record) const OSTEON_RT {
  record.wrench_step_N = rate_trip_.growth_N();
  record.wrench_step_limit_N = rate_trip_.max_rate_N_per_s() * CouplingStep_s();
}

void ServoLoop::SuperviseDevices(double model_age_s, double sensor_age_s, const CellReadings& readings,
                                 rt::Nanoseconds now) OSTEON_RT {
  safety::Ages ages{.model_s = model_age_s};
  if (params_.has_interlock) {
    ages.interlock_s = safety::StampAge(now, readings.interlock.stamp);
    if (!readings.interlock.permitted || !readings.interlock.enabled) faults_.Latch(Fault::kInterlock);
  }
  faults_.Latch(watchdog_.Check(now, ages));
  SuperviseSensor(sensor_age_s, readings, now);
  SuperviseSpindle(readings, now);
}

void ServoLoop::SuperviseHand(const Wrench& F_operator_T_W) OSTEON_RT {
  if (!safety::IsFinite(F_operator_T_W)) {
    faults_.Latch(Fault::kNotFinite);
    return;
  }
  const double force_N = F_operator_T_W.f.stableNorm();
  hand_N_ = force_N;
  statistics_.peak_sensor_force_N = std::max(statistics_.peak_sensor_force_N, force_N);
  if (sensor_trip_.Check(force_N)) faults_.Latch(Fault::kSensorForce);
}

}  // namespace osteon::control
