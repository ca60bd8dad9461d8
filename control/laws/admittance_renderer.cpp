#include "control/laws/admittance_renderer.h"

#include <algorithm>

#include "control/laws/twist_parts.h"
#include "safety/energy_limits.h"

namespace osteon::control {
namespace {

constexpr double kMaxHandTorque_Nm = 100.0;  // a larger torque of the hand is scaled down to this
// Time constant with which sight_age_s_ decays. It is long compared with the time between two frames, so that
// the speed limit does not rise and fall with every frame.
constexpr double kSightMemory_s = 0.1;

}  // namespace

AdmittanceRenderer::AdmittanceRenderer(const ServoParams& params)
    : params_(params),
      vibration_(params.vibration, params.period_s),
      axis_lock_(params.admittance, params.period_s) {}

void AdmittanceRenderer::Reset(const Pose& X_WT) OSTEON_RT {
  axis_lock_.Reset(X_WT);
  vibration_.Reset();
  mass_factor_ = 1.0;
  sight_age_s_ = 0.0;
}

AdmittanceStep AdmittanceRenderer::Step(const AdmittanceInput& input, CouplingPipeline& coupling,
                                        CommandedTool& tool) OSTEON_RT {
  AdmittanceStep step;
  step.rendered = coupling.Render(tool.arm(), step.acting);
  // vibration in the hand's wrench increases the virtual tool's mass and damping
  step.vibration.index = vibration_.Step(input.F_hand_T_W, input.spindle_rad_per_s);
  step.vibration.reference_N = vibration_.reference_N();
  tool.V_WT = AfterMassChange(tool.V_WT, vibration_.mass_factor() / mass_factor_);
  mass_factor_ = vibration_.mass_factor();
  Twist V_next_WT;
  step.finite = ComputeTwist(input, tool, coupling, step, V_next_WT);
  if (!step.finite) return step;
  step.vibration.mass_factor = mass_factor_;
  step.vibration.damping_factor = vibration_.damping_factor();

  const CouplingOutput& output = coupling.output();
  const double max_speed_m_per_s = MaxSpeed_m_per_s(output, tool.V_WT, input.reduced_speed);
  tool.V_WT = LimitMotion(V_next_WT, max_speed_m_per_s, coupling, tool, step.acting);
  tool.fade = output.fade;
  const FollowedTwist followed =
      tool.FollowTwist(ElbowSpeedLimit_m_per_s(params_, input.reduced_speed), /*elbow_moves=*/true);
  step.fault = followed.fault;
  step.acting.Add(followed.acting);
  step.acting.Add(safety::Limit::kJoints, followed.joints_limited);
  step.acting.Add(safety::Limit::kSensorAge, input.sensor_fade < 1.0);
  return step;
}

// Computes the law's next velocity. Scales the rendered wrench so that its power to the hand stays within the
// limit. Returns false if the velocity would not be finite.
bool AdmittanceRenderer::ComputeTwist(const AdmittanceInput& input, const CommandedTool& tool,
                                      CouplingPipeline& coupling, AdmittanceStep& step,
                                      Twist& V_next_WT) OSTEON_RT {
  const double fade = coupling.output().fade;
  const double hand_scale = fade * input.sensor_fade;
  const Wrench F_hand_T_W = SubtractDeadZone(
      params_.admittance, safety::ScaleWrench(input.F_hand_T_W, input.max_hand_N, kMaxHandTorque_Nm).F);
  const double damping_factor =
      std::max(vibration_.damping_factor(), coupling.stabilisers().damping_factor());
  const AdmittanceParams law = ScaleLaw(params_.admittance, mass_factor_, damping_factor);
  const Twist V_locked_C = axis_lock_.Correction(tool.X_WT());
  safety::LimitedWrench& rendered = step.rendered;
  const auto next_twist = [&](double coupling_scale, Twist& V_WT) OSTEON_RT {
    const Wrench F_T_W{.f = hand_scale * F_hand_T_W.f + coupling_scale * rendered.F.f,
                       .t = hand_scale * F_hand_T_W.t + coupling_scale * rendered.F.t};
    return NextTwist(law,
                     {.X_WT = tool.X_WT(),
                      .V_WT = tool.V_WT,
                      .F_T_W = F_T_W,
                      .dt_s = params_.period_s,
                      .V_held_C = V_locked_C},
                     V_WT);
  };
  if (!next_twist(1.0, V_next_WT)) return false;

  // The wrench changes the velocity, and thus its own power. As the velocity depends on the wrench's scale
  // linearly plus a constant, two velocities are sufficient to find the scale.
  if (!(fade * Power(rendered.F, V_next_WT) > params_.energy.max_power_W)) return true;
  Twist V_free_WT;
  const bool finite = next_twist(0.0, V_free_WT);
  const double max_power_W = params_.energy.max_power_W / fade;  // the tool moves by fade × V
  coupling.LimitPower(
      safety::PowerScale(Power(rendered.F, V_free_WT), Power(rendered.F, V_next_WT), max_power_W), rendered,
      step.acting);
  return finite && next_twist(1.0, V_next_WT);
}

// Speed limit of the tool: the smaller of the cell's limit and the speed at which the tool moves by
// model_sight_m within the contact model's age. The second limit falls at most at the deceleration of a stop.
// If the simulation stalls while the tool is fast, the tool may therefore move farther than model_sight_m for
// a moment; then the fade by the model's age stops it.
double AdmittanceRenderer::MaxSpeed_m_per_s(const CouplingOutput& coupling, const Twist& V_WT,
                                            bool reduced_speed) OSTEON_RT {
  const double dt_s = params_.period_s;
  sight_age_s_ = std::max(std::min(coupling.age_s, params_.coupling.gone_s),
                          (1.0 - dt_s / kSightMemory_s) * sight_age_s_);
  const double sight_m_per_s = params_.model_sight_m / std::max(sight_age_s_, dt_s);
  const double braked_m_per_s = V_WT.v.norm() - params_.stop_deceleration_m_per_s2 * dt_s;
  return std::min(ToolSpeedLimit_m_per_s(params_, reduced_speed), std::max(sight_m_per_s, braked_m_per_s));
}

// Limits the velocity by the speed limit, the limit of bone entry and the workspace. At a bound of the
// workspace, a tool with locked axes slows down instead of sliding along the bound.
Twist AdmittanceRenderer::LimitMotion(const Twist& V_next_WT, double max_speed_m_per_s,
                                      const CouplingPipeline& coupling, const CommandedTool& tool,
                                      safety::LimitSet& acting) const OSTEON_RT {
  using safety::Limit;
  const Vector3 p_WT = tool.X_WT().translation();
  safety::TwistLimitParams max = params_.twist;
  max.max_speed_m_per_s = max_speed_m_per_s;
  safety::LimitedTwist slow = safety::LimitTwist(V_next_WT, max);
  acting.Add(Limit::kToolSpeed, slow.share < 1.0);
  acting.Add(Limit::kBoneEntry, coupling.force_limit_reaction().Limit(tool.V_WT.v, slow.V.v));
  const safety::Workspace::Result inside = tool.workspace().Limit(p_WT, slow.V.v, params_.period_s);
  acting.Add(Limit::kWorkspace, inside.acted);
  if (!inside.acted || !axis_lock_.any()) return {.v = inside.v_WT, .w = slow.V.w};
  // With locked axes, sliding along the bound could leave a locked line. Therefore scale the whole velocity.
  // The factor 1 - |removed|² / (v · removed) reduces the velocity toward the bound by as much as the
  // workspace removed.
  const Vector3 removed = slow.V.v - inside.v_WT;
  const double along = slow.V.v.dot(removed);
  const double share = along > 0.0 ? std::max(0.0, 1.0 - removed.squaredNorm() / along) : 0.0;
  Twist V_WT = Scaled(slow.V, share);
  V_WT.v = tool.workspace().Limit(p_WT, V_WT.v, params_.period_s).v_WT;
  return V_WT;
}

}  // namespace osteon::control
