#include "control/loop/servo_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/prefetch.h"
#include "control/loop/tick_input.h"

namespace osteon::control {
namespace {

using safety::CellEvent, safety::CellState, safety::Fault;

bool AllFinite(const JointArray& q) {
  return std::all_of(q.begin(), q.end(), [](double value) { return std::isfinite(value); });
}

bool HasFiniteJoints(const ArmState& state) {
  return AllFinite(state.q_meas) && (!state.has_ipo || AllFinite(state.q_ipo));
}

// Returns the parameters. Throws std::invalid_argument if they or one of the poses are not valid.
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
              .actions = actions_}),
      motion_checks_({.params = params_,
                      .supervisor = supervisor_,
                      .session = session_,
                      .tool = tool_,
                      .hand = hand_,
                      .checks = checks_,
                      .actions = actions_,
                      .statistics = statistics_,
                      .result = result_}),
      rendering_({.params = params_,
                  .supervisor = supervisor_,
                  .session = session_,
                  .tool = tool_,
                  .hand = hand_,
                  .coupling = coupling_,
                  .checks = checks_,
                  .impedance = impedance_,
                  .actions = actions_,
                  .motion_checks = motion_checks_,
                  .statistics = statistics_,
                  .result = result_}) {}

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
          .spindle_rad_per_s = renders ? rendering_.spindle_rad_per_s() : 0.0,
          .stamp = !tool_.has_pose() ? 0
                   : use_measured    ? session_.measured_at()
                                     : now_,
          .tool_index = static_cast<std::uint8_t>(tools_.index()),
          .paused = state() == CellState::kPaused};
}

CellCommands ServoLoop::cell_commands() const OSTEON_RT {
  const bool stopping = phase() == Phase::kStopped || state() == CellState::kStop1;
  const bool stop_requested = supervisor_.stop_requested();
  return {.motion_requested = !stopping && !stop_requested,
          .spindle_rad_per_s = rendering_.SpindleCommand_rad_per_s(),
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
    supervisor_.Latch(Fault::kNotFinite);  // the arm's position is unknown, so the last command is held
    supervisor_.SetPermits({});
    // Such a message counts as missed. After several in a row the arm is regarded as lost; the first one
    // already stops the motion.
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

// Records the tick's inputs. Also records the requests made since the last tick, and clears them.
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
  requests_.TakeInto(record.input);
  return record;
}

// Changes the tool if that was requested and the loop is paused. The joints and the sensor's bias stay
// unchanged; coupling and law begin anew. The measured tool pose jumps, which is no motion, so the check of
// the arm's speed is reset.
void ServoLoop::ApplyToolRequest(TickInput& input) OSTEON_RT {
  const int index = requests_.TakeTool();
  // Before the first rendering, the sensor's bias is still being estimated with the present tool's load.
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
    rendering_.OnToolChanged();
  }
  input.tool_index = static_cast<std::uint8_t>(tools_.index());
}

void ServoLoop::RequestGains(const Gains& gains) { gains_.Request(gains); }

// Takes the gains that were requested since the last tick, and advances the ramp of all gains by one step.
void ServoLoop::StepGains(TickInput& input) OSTEON_RT {
  if (!gains_.Step(coupling_.pressed(), input)) return;
  const AdmittanceParams before = params_.admittance;
  ApplyGains(gains_.gains(), params_.admittance, params_.coupling);
  coupling_.OnGainsChanged();
  if (safety::Renders(state()) && params_.law == Law::kAdmittance)
    tool_.V_WT = AfterMassChange(before, params_.admittance, tool_.X_WT().linear(), tool_.V_WT);
}

// Applies the recorded requests. The requests to stop, and to pause a motion, are applied later in the tick
// (MotionChecks::CheckMotion).
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

// A tick without a message. The last command stays, and the virtual tool does not move. After several missed
// messages in a row, or if the link is broken, the arm is regarded as lost.
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

// Processes a message with finite joint positions: checks the arm, applies the resulting events, then moves
// the virtual tool as the cell's state requires.
void ServoLoop::ProcessArmMessage(const TickInputs& tick) OSTEON_RT {
  const ArmState& state = tick.state;
  const bool active = start_.UpdateSession(state);
  const bool overloaded = tool_.arm().PredictOverload(state.tau_ext);
  // without finite torques an overload would not be detected
  if (!AllFinite(state.tau_ext)) actions_.StopWith(Fault::kNotFinite);
  motion_checks_.CheckArmSpeed(state, active);

  if (start_.StartIfPermitted(tick, {.max_force_N = max_force_N(),
                                     .may_start = requests_.may_start(),
                                     .arm_overloaded = overloaded,
                                     .withdrawn_at = withdrawn_at_}))
    rendering_.Start(tick);
  motion_checks_.CheckMotion(state, overloaded);
  if (this->state() == CellState::kAligning) motion_checks_.CheckOnPath(tick);
  if (this->state() == CellState::kStop1) motion_checks_.CheckInStop(tick);
  if (supervisor_.on_path() && start_.StepPath(tick)) rendering_.Start(tick);

  const bool waiting = phase() == Phase::kWaiting || phase() == Phase::kAligning;
  if (active && !waiting) ++statistics_.active_ticks;
  if (safety::Renders(this->state())) {
    rendering_.Step(tick);
  } else if (this->state() == CellState::kStop2) {
    rendering_.BrakeForPause(tick);
  } else if (this->state() == CellState::kStop1 && !supervisor_.on_path()) {
    actions_.Brake(HasReducedSpeed(state), result_.acting);
  }
  session_.UpdateStandstill(state.q_meas);
  if (this->state() == CellState::kStop0 && session_.stands()) actions_.FinishStop();
}

// Writes the tick's answer to the arm: commanded joints, activation, and the impedance law's overlay.
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
  rendering_.FillRecord(record);
}

}  // namespace osteon::control
