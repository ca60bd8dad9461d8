#include "control/loop/haptic_rendering.h"

#include <algorithm>
#include <cmath>

#include "control/laws/twist_parts.h"
#include "control/loop/tool_speed_trip.h"

namespace osteon::control {
namespace {

using safety::CellEvent, safety::Fault;

constexpr double kMinSpeedRatio = 0.05;  // below this fraction of its set speed, the spindle counts as still

}  // namespace

HapticRendering::HapticRendering(const Parts& parts)
    : params_(parts.params),
      supervisor_(parts.supervisor),
      session_(parts.session),
      tool_(parts.tool),
      hand_(parts.hand),
      coupling_(parts.coupling),
      checks_(parts.checks),
      impedance_(parts.impedance),
      actions_(parts.actions),
      motion_checks_(parts.motion_checks),
      statistics_(parts.statistics),
      result_(parts.result),
      admittance_(parts.params) {}

void HapticRendering::Start(const TickInputs& tick) OSTEON_RT {
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

void HapticRendering::OnToolChanged() OSTEON_RT {
  coupling_.Reset();
  admittance_.Reset(tool_.X_WT());
}

double HapticRendering::SpindleCommand_rad_per_s() const OSTEON_RT {
  const bool on = safety::Renders(supervisor_.state()) && spindle_permitted_ && !coupling_.stops_spindle();
  return on ? params_.spindle_rad_per_s : 0.0;
}

void HapticRendering::Step(const TickInputs& tick) OSTEON_RT {
  UpdateSpindle(tick.readings);
  if (params_.law == Law::kImpedance)
    RenderImpedance(tick);
  else
    RenderAdmittance(tick);
}

// Reads the spindle's actual speed and the PLC's permission for the spindle. Applies the event "spindle
// turns" or "spindle still".
void HapticRendering::UpdateSpindle(const CellReadings& readings) OSTEON_RT {
  spindle_permitted_ = !params_.has_interlock || readings.interlock.spindle_permitted;
  const double command_rad_per_s = SpindleCommand_rad_per_s();
  const double speed = params_.has_spindle ? readings.spindle.speed_rad_per_s : command_rad_per_s;
  // only a positive speed counts, because the tool's edges cut in that direction only
  spindle_rad_per_s_ =
      std::isfinite(speed) && speed > kMinSpeedRatio * params_.spindle_rad_per_s ? speed : 0.0;
  actions_.ApplyEvent(spindle_rad_per_s_ > 0.0 ? CellEvent::kSpindleTurns : CellEvent::kSpindleStill);
}

// Computes the wrenches of hand and coupling, and runs the checks on them and on the devices. @returns the
// hand's wrench
Wrench HapticRendering::EvaluateContact(const TickInputs& tick, const ToolMotion& motion) OSTEON_RT {
  const Wrench F_hand_T_W = motion_checks_.MeasureHand(tick.readings.force);
  const CouplingOutput& coupling = coupling_.Evaluate({.model = tick.model,
                                                       .X_WT = motion.X_WT,
                                                       .V_WT = motion.V_WT,
                                                       .now = tick.now,
                                                       .spindle_turns = spindle_rad_per_s_ > 0.0},
                                                      tool_.arm(), result_.acting);
  const safety::ForceLimitReaction& reaction = coupling_.force_limit_reaction();
  result_.ages.model_s = coupling.age_s;
  result_.coupling_evaluated = true;
  statistics_.peak_tool_in_bone_m = std::max(statistics_.peak_tool_in_bone_m, reaction.tool_in_bone_m());

  supervisor_.Latch(checks_.CheckDevices(tick.readings, result_.ages, tick.now));
  supervisor_.Latch(checks_.CheckCoupling(coupling, CouplingStep_s()));
  if (reaction.too_deep()) supervisor_.Latch(Fault::kToolInBone);
  if (reaction.must_stop()) supervisor_.Latch(Fault::kForceLimit);
  return F_hand_T_W;
}

// Renders one tick by the admittance law: computes wrench and motion, then checks the resulting motion.
void HapticRendering::RenderAdmittance(const TickInputs& tick) OSTEON_RT {
  const Pose X_before = tool_.X_WT();
  const Wrench F_hand_T_W = EvaluateContact(tick, {.X_WT = X_before, .V_WT = tool_.Velocity()});
  if (supervisor_.faults().Any()) {
    Stop(tick.state);
    return;
  }
  const AdmittanceStep step = admittance_.Step({.F_hand_T_W = F_hand_T_W,
                                                .sensor_fade = checks_.SensorFade(result_.ages.sensor_s),
                                                .max_hand_N = checks_.max_hand_N(),
                                                .spindle_rad_per_s = spindle_rad_per_s_,
                                                .reduced_speed = HasReducedSpeed(tick.state)},
                                               coupling_, tool_);
  result_.vibration = step.vibration;
  result_.acting.Add(step.acting);
  statistics_.CountDepthLeft(coupling_.depth_limit());
  if (!step.finite) {
    actions_.StopWith(Fault::kNotFinite);
    actions_.Brake(HasReducedSpeed(tick.state), result_.acting);
    return;
  }
  if (step.fault != Fault::kNone) {
    actions_.StopWith(step.fault);
    actions_.BrakeJoints();
  }

  // check and record the resulting motion
  const Pose& X_WT = tool_.X_WT();
  const double speed_m_per_s = (X_WT.translation() - X_before.translation()).norm() / params_.period_s;
  if (speed_m_per_s > ToolSpeedTripLimit_m_per_s(params_)) supervisor_.Latch(Fault::kToolSpeed);
  if (coupling_.guidance_trips()) supervisor_.Latch(Fault::kWrenchRate);
  if (tool_.workspace().Violated(X_WT.translation())) supervisor_.Latch(Fault::kWorkspace);
  if (supervisor_.faults().Any()) actions_.ApplyFault();
  const double power_W = Power(step.rendered.F, SmallStep(X_before, X_WT)) / params_.period_s;
  statistics_.peak_power_W = std::max(statistics_.peak_power_W, power_W);
  StoreRendered(step.rendered, speed_m_per_s);
  StepCompliance(tick.model);
}

// Renders one tick by the impedance law, at the measured pose.
void HapticRendering::RenderImpedance(const TickInputs& tick) OSTEON_RT {
  const Twist V_before_WT = tool_.V_WT;
  tool_.V_WT = session_.V_WT();
  tool_.fade = 1.0;
  EvaluateContact(tick, {.X_WT = session_.X_WT(), .V_WT = tool_.V_WT});
  const ImpedanceMotion motion =
      impedance_.FollowHand(session_, tick.state.q_meas, HasReducedSpeed(tick.state), tool_);
  result_.acting.Add(motion.acting);
  supervisor_.Latch(motion.faults);
  if (supervisor_.faults().Any()) {
    Stop(tick.state);
    return;
  }
  const ImpedanceStep step = impedance_.Step(session_, V_before_WT, motion, coupling_, tool_);
  result_.acting.Add(step.acting);
  if (coupling_.guidance_trips()) supervisor_.Latch(Fault::kWrenchRate);
  if (supervisor_.faults().Any()) actions_.ApplyFault();
  statistics_.CountDepthLeft(coupling_.depth_limit());
  StoreRendered(step.rendered, tool_.V_WT.v.norm());
  StepCompliance(tick.model);
}

// Ends rendering because of a fault that was found before the tick rendered a wrench.
void HapticRendering::Stop(const ArmState& state) OSTEON_RT {
  result_.F_coupling_T_W = coupling_.limited().F;
  actions_.ApplyFault();
  actions_.Brake(HasReducedSpeed(state), result_.acting);
}

// Advances the compliant parts (tool, tissue, the bone's mount) with the rendered wrench, and checks their
// limits.
void HapticRendering::StepCompliance(const simulation::ContactModel& model) OSTEON_RT {
  coupling_.StepCompliance(model, result_.acting);
  const Compliance* compliance = coupling_.compliance();
  const bool over_deflected = compliance != nullptr && compliance->beyond_limit(),
             too_deep = coupling_.beyond_depth();
  if (over_deflected) supervisor_.Latch(Fault::kDeflection);
  if (too_deep) supervisor_.Latch(Fault::kWorkspace);
  if (over_deflected || too_deep) actions_.ApplyFault();
}

// Stores the rendered wrench and updates the statistics. The stored fractions include all limits from the
// coupling to the arm.
void HapticRendering::StoreRendered(const safety::LimitedWrench& rendered, double speed_m_per_s) OSTEON_RT {
  result_.rendered = true;
  result_.F_coupling_T_W = rendered.F;
  result_.wrench_scale = std::min(coupling_.limited().share, rendered.share);
  result_.arm_share = std::min(coupling_.limited().arm_share, rendered.arm_share);
  ServoStatistics& s = statistics_;
  s.peak_coupling_force_N = std::max(s.peak_coupling_force_N, rendered.F.f.norm());
  s.peak_coupling_torque_Nm = std::max(s.peak_coupling_torque_Nm, rendered.F.t.norm());
  s.peak_tool_speed_m_per_s = std::max(s.peak_tool_speed_m_per_s, speed_m_per_s);
  s.min_tank_J = std::min(s.min_tank_J, coupling_.stabilisers().tank().energy_J());
  coupling_.AddActing({.F = rendered.F, .share = result_.wrench_scale, .arm_share = result_.arm_share},
                      result_.acting);
}

void HapticRendering::BrakeForPause(const TickInputs& tick) OSTEON_RT {
  motion_checks_.MeasureHand(tick.readings.force);
  supervisor_.Latch(checks_.CheckDevices(tick.readings, result_.ages, tick.now));
  if (tick.model.status == simulation::EngineStatus::kDeviceLost) supervisor_.Latch(Fault::kDevice);
  if (supervisor_.faults().Any()) actions_.ApplyFault();
  if (!supervisor_.on_path()) actions_.Brake(HasReducedSpeed(tick.state), result_.acting);
}

void HapticRendering::FillRecord(TickRecord& record) const OSTEON_RT {
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
    const bool measured = params_.law == Law::kImpedance && safety::Renders(supervisor_.state());
    compliance->FillRecord(measured ? session_.X_WT() : tool_.X_WT(), record.compliance);
  }
}

}  // namespace osteon::control
