// ServoLoop's tick: records the inputs, applies requests and events, fills the command and the record. The
// checks are in servo_checks.cpp, the rendering in servo_rendering.cpp.

#include "control/loop/servo_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/prefetch.h"
#include "control/loop/tick_input.h"

namespace osteon::control {
namespace {

using safety::CellEvent, safety::CellState, safety::Fault;

constexpr std::uint8_t kT1 = 0;  // ArmState::operation_mode

bool AllFinite(const JointArray& q) {
  return std::all_of(q.begin(), q.end(), [](double value) { return std::isfinite(value); });
}

bool HasFiniteJoints(const ArmState& state) {
  return AllFinite(state.q_meas) && (!state.has_ipo || AllFinite(state.q_ipo));
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
      session_(params_),
      tool_(params_, std::move(arm)),
      hand_(params_, X_FT),
      coupling_(params_),
      checks_(params_, safety::WrenchLimiter(params.wrench).max_force_N()),
      admittance_(params_),
      impedance_(params_),
      gains_(GainsOf(params.admittance, params.coupling), params.period_s),
      actions_({.params = params_,
                .supervisor = supervisor_,
                .session = session_,
                .tool = tool_,
                .coupling = coupling_,
                .impedance = impedance_}),
      start_({.params = params_,
              .supervisor = supervisor_,
              .session = session_,
              .tool = tool_,
              .hand = hand_,
              .checks = checks_,
              .actions = actions_}) {}

void ServoLoop::SetTools(std::vector<LoopTool> tools, int index) {
  ToolTable table;
  table.Set(std::move(tools), index, params_);
  tool_.arm().SetTools(table.tools());
  tools_ = std::move(table);
  params_.sensor = tools_.tool().sensor;
  hand_ = HandForce(params_, tools_.tool().X_FT);
  coupling_.SetGuidance(tools_.guidance());
  coupling_.SetBending(tools_.tool().bending);
  tool_.SelectTool(static_cast<std::size_t>(index));
}

simulation::ToolCommand ServoLoop::tool_command() const OSTEON_RT {
  const bool renders = safety::Renders(state());
  const bool use_measured = params_.law == Law::kImpedance && renders;
  const Pose& X_WT = use_measured ? session_.X_WT() : tool_.X_WT();
  const Compliance* compliance = coupling_.compliance();
  return {.X_WT = compliance != nullptr ? compliance->X_ME(X_WT) : X_WT,
          .spindle_rad_per_s = renders ? spindle_rad_per_s_ : 0.0,
          .stamp = !tool_.has_pose() ? 0
                   : use_measured    ? session_.measured_at()
                                     : now_,
          .tool_index = static_cast<std::uint8_t>(tools_.index()),
          .paused = state() == CellState::kPaused};
}

CellCommands ServoLoop::cell_commands() const OSTEON_RT {
  const bool stopping = phase() == Phase::kStopped || state() == CellState::kStop1;
  const bool stop_requested = supervisor_.stop_requested();
  const bool spindle_on = safety::Renders(state()) && spindle_permitted_ && !coupling_.stops_spindle();
  return {.motion_requested = !stopping && !stop_requested,
          .spindle_rad_per_s = spindle_on ? params_.spindle_rad_per_s : 0.0,
          .quick_stop = stopping && faults().Any(),
          .clear_faults = !stop_requested && (state() == CellState::kRecovery ||
                                              (!supervisor_.moved() && safety::Waits(state())))};
}

void ServoLoop::Prefetch() const OSTEON_RT {
  rt::Prefetch(*this);
  tool_.arm().Prefetch();
}

TickRecord ServoLoop::Tick(const TickInputs& tick, ArmCommand& command) OSTEON_RT {
  const ArmState& state = tick.state;
  now_ = tick.now;
  reduced_speed_ = state.operation_mode == kT1;
  TickRecord record = RecordInputs(tick);
  result_ = {.ages = {.model_s = tick.model.frame == 0 ? safety::kNoAge_s
                                                       : safety::AgeSeconds(tick.now, tick.model.pose_stamp),
                      .sensor_s = safety::StampAge(tick.now, tick.readings.force.stamp)}};
  ApplyToolRequest(record.input);
  StepGains(record.input);
  ApplyRequests(record.input);
  impedance_.ClearWrench();

  if (tick.received != ReceiveResult::kOk) {
    OnMissedMessage(tick.received);
  } else if (!HasFiniteJoints(state)) {
    supervisor_.Latch(Fault::kNotFinite);  // the arm's position is unknown: the last command is held
    supervisor_.SetPermits({});
    // Such a message counts as missed: the arm is lost after several in a row, and brakes before that.
    actions_.ApplyEvent(session_.OnMissedMessage() ? CellEvent::kArmLost : CellEvent::kFault);
  } else {
    session_.OnMessage(state, tool_.arm().ToolPose(state.q_meas), tick.now);
    ProcessArmMessage(tick);
  }

  if (!cell_commands().motion_requested) withdrawn_at_ = tick.now;
  FillCommand(state, command);
  statistics_.limits.Count(result_.acting);
  FinishRecord(command, record);
  return record;
}

// Records the tick's inputs, among them the requests made since the last tick, which are thereby taken.
TickRecord ServoLoop::RecordInputs(const TickInputs& tick) OSTEON_RT {
  const auto& [state, received, readings, model, now] = tick;
  supervisor_.SetStopRequested(requests_.stop());
  TickRecord record;
  record.tick = tick_++;
  record.stamp = received == ReceiveResult::kOk ? state.stamp : now;
  record.session_state = static_cast<std::uint8_t>(state.session);
  record.q_meas = state.q_meas;
  record.model_frame = model.frame;
  record.input = MakeTickInput(tick, supervisor_.stop_requested());
  record.input.recover = requests_.TakeRecovery();
  record.input.pause = requests_.TakePause();
  record.input.resume = requests_.TakeResume();
  const double guidance_gain = requests_.TakeGuidanceGain();
  record.input.has_guidance_gain = !std::isnan(guidance_gain);
  if (record.input.has_guidance_gain) record.input.guidance_gain = guidance_gain;
  record.input.repeat_differed = std::exchange(differed_, false);
  record.input.recorder_stalled = std::exchange(recorder_stalled_, false);
  return record;
}

// Changes the tool if that was requested and the loop is paused. The joints and the sensor's bias stay; what
// belongs to the old tool's contact begins anew. The measured pose jumps with the tool, which is no motion.
void ServoLoop::ApplyToolRequest(TickInput& input) OSTEON_RT {
  const int index = requests_.TakeTool();
  // before the first rendering the sensor's bias is still estimated, with the load of the tool that is on
  const bool at_rest = state() == CellState::kPaused && supervisor_.rendered();
  if (tools_.IsOther(index) && at_rest) {
    const Pose X_TN = tools_.Select(index);
    params_.sensor = tools_.tool().sensor;
    hand_.SetTool(tools_.tool().sensor, tools_.tool().X_FT);
    tool_.SelectTool(static_cast<std::size_t>(index));
    session_.ChangeTool(X_TN);
    checks_.ResetArmSpeed();
    coupling_.SetGuidance(tools_.guidance());
    coupling_.SetBending(tools_.tool().bending);
    coupling_.Reset();
    admittance_.Reset(tool_.X_WT());
  }
  input.tool_index = static_cast<std::uint8_t>(tools_.index());
}

void ServoLoop::RequestGains(const Gains& gains) { gains_.Request(gains); }

// Takes gains requested since the last tick, and moves all gains by one step of their ramp.
void ServoLoop::StepGains(TickInput& input) OSTEON_RT {
  if (!gains_.Step(coupling_.pressed(), input)) return;
  const AdmittanceParams before = params_.admittance;
  ApplyGains(gains_.gains(), params_.admittance, params_.coupling);
  coupling_.OnGainsChanged();
  if (safety::Renders(state()) && params_.law == Law::kAdmittance)
    tool_.V_WT = AfterMassChange(before, params_.admittance, tool_.X_WT().linear(), tool_.V_WT);
}

// Applies the recorded requests. A stop, and a pause of a motion, are applied later in the tick
// (CheckMotion).
void ServoLoop::ApplyRequests(const TickInput& input) OSTEON_RT {
  if (input.recover && CanRecover()) actions_.ApplyEvent(CellEvent::kRecover);
  if (input.resume && !input.stop) actions_.ApplyEvent(CellEvent::kResume);
  if (input.has_guidance_gain) coupling_.SetGuidanceGain(input.guidance_gain);
  supervisor_.RequestPause(input.pause);
  if (safety::Waits(state()) && supervisor_.TakePauseRequest())
    actions_.ApplyEvent(CellEvent::kPauseRequested);
  if (input.repeat_differed) actions_.StopWith(Fault::kRepeatDiffers);
  if (input.recorder_stalled) actions_.StopWith(Fault::kRecorder);
}

// Without a message there is nothing to answer: the last command stays, and the virtual tool does not move.
// Several missed messages in a row, or a broken link, mean that the arm is lost.
void ServoLoop::OnMissedMessage(ReceiveResult received) OSTEON_RT {
  supervisor_.SetPermits({});
  const bool booting = safety::Waits(state()) && received == ReceiveResult::kTimeout;
  if (!booting) {
    ++statistics_.missed_messages;
    const bool lost = session_.OnMissedMessage() || received != ReceiveResult::kTimeout;
    if (lost && phase() != Phase::kStopped) {
      supervisor_.Latch(Fault::kArmStale);
      actions_.ApplyEvent(CellEvent::kArmLost);
    }
  }
  if (supervisor_.stop_requested() && supervisor_.IsWaitingOrPaused())
    actions_.ApplyEvent(CellEvent::kStopRequested);
}

// Processes a message with finite joint positions: checks the arm, applies the events that follow from it,
// then moves the virtual tool as the cell's state demands.
void ServoLoop::ProcessArmMessage(const TickInputs& tick) OSTEON_RT {
  const ArmState& state = tick.state;
  const bool active = start_.UpdateSession(state);
  arm_overloaded_ = tool_.arm().PredictOverload(state.tau_ext);
  // without finite torques an overload would not be detected
  if (!AllFinite(state.tau_ext)) actions_.StopWith(Fault::kNotFinite);
  CheckArmSpeed(state, active);

  if (start_.StartIfPermitted(tick, {.max_force_N = max_force_N(),
                                     .may_start = requests_.may_start(),
                                     .arm_overloaded = arm_overloaded_,
                                     .withdrawn_at = withdrawn_at_}))
    StartRendering(tick);
  CheckMotion(state);
  if (this->state() == CellState::kAligning) CheckOnPath(tick);
  if (this->state() == CellState::kStop1) CheckInStop(tick);
  if (supervisor_.on_path() && start_.StepPath(tick)) StartRendering(tick);

  const bool waiting = phase() == Phase::kWaiting || phase() == Phase::kAligning;
  if (active && !waiting) ++statistics_.active_ticks;
  if (safety::Renders(this->state())) {
    UpdateSpindle(tick.readings);
    if (params_.law == Law::kImpedance)
      RenderImpedance(tick);
    else
      RenderAdmittance(tick);
  } else if (this->state() == CellState::kStop2) {
    BrakeForPause(tick);
  } else if (this->state() == CellState::kStop1 && !supervisor_.on_path()) {
    actions_.Brake(reduced_speed_, result_.acting);
  }
  session_.UpdateStandstill(state.q_meas);
  if (this->state() == CellState::kStop0 && session_.stands()) actions_.FinishStop();
}

void ServoLoop::FillCommand(const ArmState& state, ArmCommand& command) const OSTEON_RT {
  command.q = tool_.arm().q();
  command.activation = session_.activation();
  impedance_.FillWrenchOverlay(state, session_.X_WT(), tool_.arm(), command);
}

// Records the results of the tick and of its parts.
void ServoLoop::FinishRecord(const ArmCommand& command, TickRecord& record) const OSTEON_RT {
  record.limits = result_.acting.bits();
  record.phase = phase();
  record.cell_state = static_cast<std::uint8_t>(state());
  record.permits = permits().bits();
  record.faults = faults().bits();
  record.q_cmd = command.q;
  record.activation_cmd = command.activation;
  record.F_cmd_T = command.F;
  record.tau_cmd = command.tau;
  record.X_WT_cmd = tool_.X_WT();
  record.X_WT_meas = session_.X_WT();
  record.v_WT_cmd_m_per_s = Vector3(tool_.fade * tool_.V_WT.v);
  record.spindle_rad_per_s = tool_command().spindle_rad_per_s;
  record.F_bias_S = hand_.bias();
  record.model_age_s = result_.ages.model_s;
  record.sensor_age_s = result_.ages.sensor_s;
  record.tool_speed_meas_m_per_s = result_.arm_speed_m_per_s;
  record.F_operator_T_W = result_.F_hand_T_W;
  record.vibration_index = result_.vibration.index;
  record.vibration_reference_N = result_.vibration.reference_N;
  record.mass_factor = result_.vibration.mass_factor;
  record.damping_factor = result_.vibration.damping_factor;
  record.F_coupling_T_W = result_.F_coupling_T_W;
  record.wrench_scale = result_.wrench_scale;
  record.arm_share = result_.arm_share;
  if (result_.coupling_evaluated) {
    record.tool_in_bone_m = coupling_.force_limit_reaction().tool_in_bone_m();
    record.wrench_step_N = checks_.wrench_growth_N();
    record.wrench_step_limit_N = checks_.max_wrench_growth_N(CouplingStep_s());
  }
  if (result_.rendered) {
    coupling_.stabilisers().FillRecord(record);
    if (coupling_.guidance()) record.guidance = coupling_.guidance()->Record();
  }
  if (const Compliance* compliance = coupling_.compliance()) {
    const bool measured = params_.law == Law::kImpedance && safety::Renders(state());
    compliance->FillRecord(measured ? session_.X_WT() : tool_.X_WT(), record.compliance);
  }
}

}  // namespace osteon::control
