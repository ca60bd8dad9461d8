// ServoLoop's impedance law: the arm carries itself and is where the hand has it; the loop adds a wrench.

#include <algorithm>

#include "control/servo_loop.h"
#include "control/tool_speed_trip.h"
#include "control/twist_parts.h"

namespace osteon::control {
namespace {

using safety::Fault;

// Slower is standing, as a tool: joints that swing about a tool at rest are the arm's own affair.
constexpr double kToolStands_m_per_s = 5e-3, kToolStands_rad_per_s = 0.5;

}  // namespace

bool ServoLoop::ModeFits(CommandMode mode) const OSTEON_RT {
  const bool overlay = mode == CommandMode::kWrench || mode == CommandMode::kTorque;
  return overlay == (params_.law == Law::kImpedance);
}

void ServoLoop::RenderImpedance(const CellReadings& readings, const simulation::ContactModel& model,
                                rt::Nanoseconds now, TickRecord& record) OSTEON_RT {
  const double dt_s = params_.period_s;
  TakeSpindle(readings);
  const Twist V_before_WT = V_WT_;
  V_WT_ = measured_twist_.V();
  share_ = 1.0;

  const Wrench F_operator_T_W = TakeSensor(readings, record);
  const CouplingOutput coupling =
      EvaluateCoupling(params_.coupling, model, X_WT_meas_, V_WT_, now, spindle_rad_per_s_ > 0.0, coupling_);
  record.model_age_s = coupling.age_s;
  pressed_ = !coupling.displacement_W.isZero(0.0);
  if (!safety::IsFinite(coupling.F_T_W)) faults_.Latch(Fault::kNotFinite);
  const safety::LimitedWrench limited = LimitCoupling(coupling, X_WT_meas_, V_WT_);
  force_limit_reaction_.Step({.displacement_W = coupling.displacement_W,
                              .rendered_share = limited.share,
                              .advance_m_per_s = spindle_rad_per_s_ > 0.0 ? model.advance_m_per_s : 0.0});
  record.tool_in_bone_m = force_limit_reaction_.tool_in_bone_m();
  Supervise(coupling, F_operator_T_W, record.sensor_age_s, readings, now);
  PutWrenchStep(record);

  // what the tool may do: braked beyond it
  safety::TwistLimitParams most = params_.twist;
  most.max_speed_m_per_s = ToolSpeedLimit_m_per_s(params_, reduced_);
  safety::LimitedTwist slow = safety::LimitTwist(V_WT_, most);
  // a period's step of the joints: messages that were lost make the way between two of them longer
  JointArray q_before = record.q_meas;
  for (std::size_t i = 0; i < q_before.size(); ++i)
    q_before[i] -= (dt_s / elapsed_s_) * (record.q_meas[i] - q_meas_before_[i]);
  const ZoneLook zones = arm_->LookAtZones(elapsed_s_ > dt_s ? q_before : q_meas_before_, record.q_meas);
  q_meas_before_ = record.q_meas;
  slow.V = Scaled(slow.V, zones.share);
  acting_.Add(safety::Limit::kZones, zones.share < 1.0);
  const safety::Workspace::Result inside = workspace_.Limit(X_WT_meas_.translation(), slow.V.v, dt_s);
  const double speed_m_per_s = V_WT_.v.norm();
  if (speed_m_per_s > ToolSpeedTrip_m_per_s(params_)) faults_.Latch(Fault::kToolSpeed);
  if (workspace_.Violated(X_WT_meas_.translation()) || zones.outside) faults_.Latch(Fault::kWorkspace);

  // the equilibrium of the arm's own spring goes along
  const Fault refused =
      arm_->FollowMeasured(record.q_meas, elapsed_s_ / (elapsed_s_ + params_.impedance.follow_s));
  if (refused != Fault::kNone) faults_.Latch(refused);
  if (faults_.Any()) {
    record.F_coupling_T_W = limited.F;
    Take(safety::CellEvent::kFault);
    Brake();
    return;
  }

  safety::LimitedWrench rendered = LimitRenderedWrench(
      stabilisers_.Calm(coupling, X_WT_meas_, V_WT_, limited, wrench_limiter_),
      depth_limit_.Step(X_WT_meas_.translation(), V_WT_.v, params_.coupling.max_stiffness_N_per_m),
      coupling.fade);
  // the hand has the arm: its velocity in the tick to come is the measured one, going on as it came
  const Twist V_next_WT{.v = 2.0 * V_WT_.v - V_before_WT.v, .w = 2.0 * V_WT_.w - V_before_WT.w};
  LimitPower(std::min(safety::PowerShare(rendered.F, V_WT_, params_.energy.max_power_W),
                      safety::PowerShare(rendered.F, V_next_WT, params_.energy.max_power_W)),
             rendered);
  const Wrench& F_coupling_T_W = rendered.F;
  const Wrench damping = DampingWrench(Times(params_.impedance, stabilisers_.damping_factor()),
                                       X_WT_meas_.linear(), V_WT_, {.v = inside.v_WT, .w = slow.V.w});
  const safety::LimitedWrench sent =
      arm_->Limit(wrench_limiter_, {.f = F_coupling_T_W.f + damping.f, .t = F_coupling_T_W.t + damping.t});
  F_sent_T_W_ = sent.F;
  acting_.Add(safety::Limit::kArmTorque, sent.arm_share < 1.0);
  record.F_coupling_T_W = F_coupling_T_W;
  stabilisers_.Put(record);
  record.wrench_scale = std::min(limited.share, rendered.share);
  record.arm_share = std::min(limited.arm_share, rendered.arm_share);

  CountRendered({.F = rendered.F, .share = record.wrench_scale, .arm_share = record.arm_share}, speed_m_per_s,
                slow.share < 1.0, inside.acted, coupling.fade, 1.0);
}

// A stop of an arm that gives: its own spring holds it where it is now, and what still moves is braked for
// the stop's time. It is at rest once its tool is measured to stand: a hand that leads it on keeps the stop
// under way.
void ServoLoop::BrakeImpedance() OSTEON_RT {
  V_WT_ = measured_twist_.V();
  // the last kStandingTicks of a stop are ticks in a row in which it stands
  const int braked = JointStopTicks(params_), whole_stop = braked + kStandingTicks;
  const bool stands = V_WT_.v.norm() <= kToolStands_m_per_s && V_WT_.w.norm() <= kToolStands_rad_per_s;
  if (stop_ticks_ == 0) stop_brake_.Reset();
  if (stop_ticks_ < braked)
    F_sent_T_W_ =
        arm_->Limit(wrench_limiter_, stop_brake_.Step(params_.impedance, X_WT_meas_.linear(), V_WT_)).F;
  stop_ticks_ = stop_ticks_ < braked || stands ? stop_ticks_ + 1 : braked;
  if (stop_ticks_ < whole_stop) return;
  F_sent_T_W_ = {};
  TakeRest();
}

// What goes to the arm beside the joints. Zero wherever this tick has rendered nothing, also where the arm
// has not said where it is.
void ServoLoop::PutWrench(const ArmState& state, ArmCommand& command) const OSTEON_RT {
  command.F = {};
  command.tau = {};
  if (F_sent_T_W_.f.isZero(0.0) && F_sent_T_W_.t.isZero(0.0)) return;
  const Matrix3 R_TW = X_WT_meas_.linear().transpose();
  if (state.command_mode == CommandMode::kWrench)
    command.F = Wrench{.f = R_TW * F_sent_T_W_.f, .t = R_TW * F_sent_T_W_.t};
  if (state.command_mode == CommandMode::kTorque) command.tau = arm_->Torques(state.q_meas, F_sent_T_W_);
}

}  // namespace osteon::control
