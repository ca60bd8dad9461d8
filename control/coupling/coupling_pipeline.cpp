#include "control/coupling/coupling_pipeline.h"

namespace osteon::control {

using safety::Limit;

CouplingPipeline::CouplingPipeline(const ServoParams& params)
    : params_(params),
      limiter_(params.wrench),
      stored_energy_limit_(params.energy.max_stored_J),
      depth_limit_(params.depth),
      force_limit_reaction_(params.on_force_limit, params.stop_deceleration_m_per_s2, params.period_s),
      stabilisers_(params.stabilisers, LawOf(params), params.period_s) {
  limiter_.LowerForceLimit(ForceLimit_N(params));
  if (params.guidance) guidance_.emplace(*params.guidance, params.twist.max_speed_m_per_s, params.period_s);
  if (params.compliance.any()) compliance_.emplace(params.compliance, params.period_s);
}

void CouplingPipeline::Reset() OSTEON_RT {
  state_ = {};
  pressed_ = false;
  stabilisers_.Reset();
  stored_energy_limit_.Reset();
  force_limit_reaction_.Reset();
  depth_limit_.Reset();
  if (guidance_) guidance_->Reset();
  if (compliance_) compliance_->Reset();
}

void CouplingPipeline::OnGainsChanged() OSTEON_RT {
  limiter_.LowerForceLimit(ForceLimit_N(params_));
  if (params_.law == Law::kAdmittance) stabilisers_.SetLaw(LawOf(params_.admittance, params_));
}

const CouplingOutput& CouplingPipeline::Evaluate(const CouplingInput& input, const ArmFollower& arm,
                                                 safety::LimitSet& acting) OSTEON_RT {
  X_WT_ = input.X_WT;
  V_WT_ = input.V_WT;
  X_ME_ = compliance_ ? compliance_->X_ME(X_WT_) : X_WT_;
  V_ME_ = compliance_ ? compliance_->V_ME(X_WT_, V_WT_) : V_WT_;
  passed_scale_ = 1.0;
  output_ = EvaluateCoupling(params_.coupling,
                             {.model = input.model,
                              .X_WT = X_ME_,
                              .V_WT = V_ME_,
                              .now = input.now,
                              .spindle_turns = input.spindle_turns},
                             state_);
  pressed_ = !output_.displacement_W.isZero(0.0);

  const Wrench scaled_E = stabilisers_.ScaleCoupling(output_, X_ME_, V_ME_), scaled = OnTool(scaled_E);
  const double spring_scale = stored_energy_limit_.Step(output_.displacement_W.norm(), output_.potential_J);
  if (spring_scale == 1.0) {
    limited_ = arm.Limit(limiter_, scaled);
  } else {
    acting.Add(Limit::kStoredEnergy);
    limited_ = arm.Limit(limiter_, {.f = spring_scale * scaled.f, .t = spring_scale * scaled.t});
    limited_.share *= spring_scale;
  }
  limited_E_ = limited_;
  Vector3 displacement_W = output_.displacement_W;
  if (compliance_) {
    limited_E_.F = {.f = limited_.share * scaled_E.f, .t = limited_.share * scaled_E.t};
    displacement_W = compliance_->X_WM().linear() * displacement_W;
  }
  force_limit_reaction_.Step({.displacement_W = displacement_W,
                              .rendered_scale = limited_.share,
                              .advance_m_per_s = input.spindle_turns ? input.model.advance_m_per_s : 0.0});
  return output_;
}

safety::LimitedWrench CouplingPipeline::Render(const ArmFollower& arm, safety::LimitSet& acting) OSTEON_RT {
  safety::LimitedWrench rendered{
      .F = stabilisers_.AddPassivityDamping(output_, X_ME_, V_ME_, limited_E_, limiter_)};
  if (compliance_) rendered.F = limiter_.Limit(OnTool(rendered.F)).F;
  const bool moves_with_bone = compliance_ && depth_limit_.rides_on_bone();
  Vector3 f_depth_W =
      depth_limit_.Step(moves_with_bone ? X_ME_.translation() : X_WT_.translation(),
                        moves_with_bone ? V_ME_.v : V_WT_.v, params_.coupling.max_stiffness_N_per_m);
  if (moves_with_bone) f_depth_W = compliance_->X_WM().linear() * f_depth_W;
  if (depth_limit_.acts()) {
    acting.Add(Limit::kDepth, depth_limit_.resists());
    if (!f_depth_W.isZero(0.0))
      rendered = arm.Limit(limiter_, {.f = rendered.F.f + output_.fade * f_depth_W, .t = rendered.F.t});
  }
  if (guidance_) {
    AddGuidance(arm, rendered.F);
    acting.Add(Limit::kGuidance, guidance_->acts());
  }
  return rendered;
}

// Adds the guidance's wrench to a wrench that is within the limits, with the largest share for which the sum
// stays within them.
void CouplingPipeline::AddGuidance(const ArmFollower& arm, Wrench& F_T_W) OSTEON_RT {
  const double proposed = guidance_->ProposeScale({.X_WT = X_WT_, .V_WT = V_WT_, .model_fade = output_.fade});
  if (guidance_->field().inside) {
    guidance_->AcceptScale(proposed);
    return;
  }
  const Wrench& guidance = guidance_->field().F_T_W;
  const auto sum_with = [&](double share) OSTEON_RT {
    return Wrench{.f = F_T_W.f + share * guidance.f, .t = F_T_W.t + share * guidance.t};
  };
  // The closed form gives the largest share within the limits of force and torque. If the arm cannot hold
  // that sum, which is rare, the share is found by bisection.
  const double share = MaxFittingScale(
      ScaleWithin(limiter_, F_T_W, guidance, proposed),
      [&](double each) OSTEON_RT { return arm.Limit(limiter_, sum_with(each)).share >= 1.0; });
  guidance_->AcceptScale(share);
  if (share > 0.0) F_T_W = sum_with(share);
}

void CouplingPipeline::LimitPower(double power_scale, safety::LimitedWrench& rendered,
                                  safety::LimitSet& acting) OSTEON_RT {
  if (!(power_scale < 1.0)) return;
  acting.Add(Limit::kPower);
  rendered.F = {.f = power_scale * rendered.F.f, .t = power_scale * rendered.F.t};
  rendered.share *= power_scale;
  passed_scale_ *= power_scale;
  stabilisers_.ScaleRendered(power_scale);
  if (guidance_) guidance_->ScaleRendered(power_scale);
}

// Converts a wrench on the head, in the bone's frame, to the wrench on T in W.
Wrench CouplingPipeline::OnTool(const Wrench& F_E_M) const OSTEON_RT {
  return compliance_ ? compliance_->OnTool(F_E_M, X_WT_) : F_E_M;
}

// The part of the rendered wrench that the planes exert, on the head. It does not include the spindle's
// torque.
Wrench CouplingPipeline::RenderedByPlanes() const OSTEON_RT {
  const double stabiliser_scale = stabilisers_.governor().wrench_scale() * stabilisers_.tank().scale();
  const double scale = stabiliser_scale * limited_E_.share;
  return {.f = passed_scale_ * limited_E_.F.f,
          .t = passed_scale_ * (limited_E_.F.t - scale * (output_.F_T_W.t - output_.F_contact_T_W.t))};
}

void CouplingPipeline::StepCompliance(const simulation::ContactModel& model,
                                      safety::LimitSet& acting) OSTEON_RT {
  if (!compliance_) return;
  compliance_->Step(RenderedByPlanes(), model, X_WT_);
  acting.Add(Limit::kDeflection, compliance_->noticed());
}

bool CouplingPipeline::beyond_depth() const OSTEON_RT {
  constexpr double kTolerance_m = 1e-3;  // a smaller distance beyond the bound is tolerated
  return depth_limit_.acts() && depth_limit_.rides_on_bone() && depth_limit_.distance_m() < -kTolerance_m;
}

void CouplingPipeline::AddActing(const safety::LimitedWrench& rendered,
                                 safety::LimitSet& acting) const OSTEON_RT {
  acting.Add(Limit::kWrench, rendered.share < 1.0);
  acting.Add(Limit::kArmTorque, rendered.arm_share < 1.0);
  acting.Add(Limit::kStoredEnergy,
             rendered.share < 1.0 && limiter_.max_force_N() < params_.wrench.max_force_N);
  acting.Add(Limit::kModelAge, output_.fade < 1.0);
  acting.Add(Limit::kAgeGovernor, stabilisers_.governor().acted());
  acting.Add(Limit::kPassivity, stabilisers_.passivity().acted());
  acting.Add(Limit::kTank, stabilisers_.tank().acted());
}

}  // namespace osteon::control
