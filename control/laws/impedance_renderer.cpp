#include "control/laws/impedance_renderer.h"

#include <algorithm>

#include "control/laws/twist_parts.h"
#include "control/loop/tool_speed_trip.h"
#include "safety/energy_limits.h"

namespace osteon::control {
namespace {

using safety::Fault, safety::Limit;

// A tool that is slower than this counts as standing still. The arm's joints may still swing; only the arm's
// own damping can stop that.
constexpr double kToolStands_m_per_s = 5e-3, kToolStands_rad_per_s = 0.5;

}  // namespace

void ImpedanceRenderer::Reset(const JointArray& q_meas) OSTEON_RT {
  q_before_ = q_meas;
  stop_ticks_ = 0;
}

ImpedanceMotion ImpedanceRenderer::FollowHand(const ArmSession& arm, const JointArray& q_meas,
                                              bool reduced_speed, CommandedTool& tool) OSTEON_RT {
  ImpedanceMotion motion;
  const double dt_s = params_.period_s, elapsed_s = arm.elapsed_s();
  const Vector3 p_WT = arm.X_WT().translation();
  safety::TwistLimitParams max = params_.twist;
  max.max_speed_m_per_s = ToolSpeedLimit_m_per_s(params_, reduced_speed);
  safety::LimitedTwist slow = safety::LimitTwist(tool.V_WT, max);
  motion.twist_limited = slow.share < 1.0;
  // Joint positions one period before the measured ones. If messages were lost, q_before_ is older, so
  // interpolate.
  JointArray q_step = q_meas;
  for (std::size_t i = 0; i < q_step.size(); ++i)
    q_step[i] -= (dt_s / elapsed_s) * (q_meas[i] - q_before_[i]);
  const ZoneCheck zones = tool.arm().CheckZones(elapsed_s > dt_s ? q_step : q_before_, q_meas);
  q_before_ = q_meas;
  slow.V = Scaled(slow.V, zones.share);
  motion.acting.Add(Limit::kZones, zones.share < 1.0);
  const safety::Workspace::Result inside = tool.workspace().Limit(p_WT, slow.V.v, dt_s);
  motion.workspace_limited = inside.acted;
  motion.V_allowed_WT = {.v = inside.v_WT, .w = slow.V.w};
  if (tool.V_WT.v.norm() > ToolSpeedTripLimit_m_per_s(params_)) motion.faults.Latch(Fault::kToolSpeed);
  if (tool.workspace().Violated(p_WT) || zones.outside) motion.faults.Latch(Fault::kWorkspace);

  // let the equilibrium of the arm's own spring follow the measured joints
  motion.faults.Latch(
      tool.arm().FollowMeasured(q_meas, elapsed_s / (elapsed_s + params_.impedance.follow_s)));
  return motion;
}

ImpedanceStep ImpedanceRenderer::Step(const ArmSession& arm, const Twist& V_before_WT,
                                      const ImpedanceMotion& motion, CouplingPipeline& coupling,
                                      const CommandedTool& tool) OSTEON_RT {
  ImpedanceStep step;
  step.acting.Add(Limit::kToolSpeed, motion.twist_limited);
  step.acting.Add(Limit::kWorkspace, motion.workspace_limited);
  const Twist& V_WT = tool.V_WT;
  safety::LimitedWrench& rendered = step.rendered;
  rendered = coupling.Render(tool.arm(), step.acting);
  // The hand moves the arm, so the next tick's velocity is unknown. Extrapolate it from the last two measured
  // ones.
  const Twist V_next_WT{.v = 2.0 * V_WT.v - V_before_WT.v, .w = 2.0 * V_WT.w - V_before_WT.w};
  const double max_power_W = params_.energy.max_power_W;
  coupling.LimitPower(std::min(safety::PowerScale(rendered.F, V_WT, max_power_W),
                               safety::PowerScale(rendered.F, V_next_WT, max_power_W)),
                      rendered, step.acting);
  const Wrench damping = DampingWrench(ScaleLaw(params_.impedance, coupling.stabilisers().damping_factor()),
                                       arm.X_WT().linear(), V_WT, motion.V_allowed_WT);
  const safety::LimitedWrench sent =
      tool.arm().Limit(coupling.limiter(), {.f = rendered.F.f + damping.f, .t = rendered.F.t + damping.t});
  F_sent_T_W_ = sent.F;
  coupling.OnWrenchScaled(sent.share);
  step.acting.Add(Limit::kArmTorque, sent.arm_share < 1.0);
  return step;
}

bool ImpedanceRenderer::Brake(const ArmSession& arm, const safety::WrenchLimiter& limiter,
                              CommandedTool& tool) OSTEON_RT {
  tool.V_WT = arm.V_WT();
  // A stop consists of `braking_ticks` ticks of braking, then kStandingMessages ticks in a row in which the
  // tool stands still.
  const int braking_ticks = JointStopTicks(params_),
            total_ticks = braking_ticks + ArmSession::kStandingMessages;
  const bool stands =
      tool.V_WT.v.norm() <= kToolStands_m_per_s && tool.V_WT.w.norm() <= kToolStands_rad_per_s;
  if (stop_ticks_ == 0) stop_brake_.Reset();
  if (stop_ticks_ < braking_ticks)
    F_sent_T_W_ =
        tool.arm().Limit(limiter, stop_brake_.Step(params_.impedance, arm.X_WT().linear(), tool.V_WT)).F;
  stop_ticks_ = stop_ticks_ < braking_ticks || stands ? stop_ticks_ + 1 : braking_ticks;
  if (stop_ticks_ < total_ticks) return false;
  F_sent_T_W_ = {};
  return true;
}

void ImpedanceRenderer::FillWrenchOverlay(const ArmState& state, const Pose& X_WT_meas,
                                          const ArmFollower& arm, ArmCommand& command) const OSTEON_RT {
  command.F = {};
  command.tau = {};
  if (F_sent_T_W_.f.isZero(0.0) && F_sent_T_W_.t.isZero(0.0)) return;
  const Matrix3 R_TW = X_WT_meas.linear().transpose();
  if (state.command_mode == CommandMode::kWrench)
    command.F = Wrench{.f = R_TW * F_sent_T_W_.f, .t = R_TW * F_sent_T_W_.t};
  if (state.command_mode == CommandMode::kTorque) command.tau = arm.Torques(state.q_meas, F_sent_T_W_);
}

}  // namespace osteon::control
