#include "hil/operator/operator_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteon::hil {
namespace {

// Shortens a vector to the norm max_size if it is longer; keeps its direction.
Vector3 LimitNorm(const Vector3& v, double max_size) {
  const double size = v.norm();
  return size > max_size ? Vector3(v * (max_size / size)) : v;
}

// Remaining height below which the operator reduces the push, and the lag of the person's reaction to what is
// seen (both assumed).
constexpr double kNearlyDone_m = 0.3e-3, kSight_s = 0.25;

// Bounds the component of a force along a unit axis to -share_against × max_N … max_N; does not change the
// perpendicular components.
Vector3 LimitAxially(const Vector3& f, const Vector3& axis, double max_N, double share_against) {
  const double axial_N = axis.dot(f);
  return f + (std::clamp(axial_N, -share_against * max_N, max_N) - axial_N) * axis;
}

}  // namespace

OperatorHand::OperatorHand(const OperatorHandParams& params, HandScript script)
    : params_(params),
      script_(std::move(script)),
      impedance_(params),
      tremor_(params.tremor_N, params.tremor_seed) {
  const auto check = [](const char* name, double found, bool zero_too) {
    if (std::isfinite(found) && (found > 0.0 || (zero_too && found == 0.0))) return;
    throw std::invalid_argument(
        fmt::format("operator's hand: {}: found {}, accepted {} 0", name, found, zero_too ? ">=" : ">"));
  };
  check("stiffness_N_per_m", params.stiffness_N_per_m, true);
  check("damping_Ns_per_m", params.damping_Ns_per_m, true);
  check("mass_kg", params.mass_kg, true);
  check("stiffness_Nm_per_rad", params.stiffness_Nm_per_rad, true);
  check("damping_Nms_per_rad", params.damping_Nms_per_rad, true);
  check("inertia_kgm2", params.inertia_kgm2, true);
  check("grip_time_s", params.grip_time_s, false);
  check("max_force_N", params.max_force_N, false);
  check("max_torque_Nm", params.max_torque_Nm, false);
  check("tremor_N", params.tremor_N, true);
  CheckIncidents(params.incidents);
}

Wrench HandImpedance::StepMass(double period_s, const Twist& V, double grip) noexcept {
  if (grip == 0.0) {
    V_mass_ = {};
    return {};
  }
  // backward Euler step of the mass's velocity: v_m' = grip (v - v_m) / tau
  const double share = period_s * grip / (params_.grip_time_s + period_s * grip);
  const Twist dV{.v = share * (V.v - V_mass_.v), .w = share * (V.w - V_mass_.w)};
  V_mass_.v += dV.v;
  V_mass_.w += dV.w;
  return {.f = params_.mass_kg / period_s * dV.v, .t = params_.inertia_kgm2 / period_s * dV.w};
}

Wrench HandImpedance::Step(double period_s, const Pose& X, const Twist& V, const Pose& X_target,
                           const Twist& V_target) noexcept {
  const Wrench F_mass = StepMass(period_s, V, 1.0);
  const Wrench pull = params_.spring().Pull(X, V, X_target, V_target);
  return {.f = pull.f - F_mass.f, .t = pull.t - F_mass.t};
}

void OperatorHand::Reset() noexcept {
  impedance_.Reset();
  push_share_ = 1.0;
  pushed_N_ = 0.0;
  holding_ = IncidentMoment::kNone;
  kept_ = {};
}

Wrench OperatorHand::Step(double time_s, double period_s, const Pose& X_WT, const Twist& V_WT) noexcept {
  const HandTarget target = script_.Sample(time_s);
  const IncidentMoment moment = MomentOf(params_.incidents, time_s);
  Handle handle = HandleAt(target, X_WT, V_WT);
  handle.tremor_N = tremor_.ForceAt(time_s);
  handle.F_mass = impedance_.StepMass(period_s, handle.V, moment.grip);
  push_share_ = PushShare(period_s, target, handle.X.translation());

  // wrench of the hand's impedance at the head's centre
  if (moment.holding != holding_) ChangeSpring(moment, target.force_limit_N, handle);
  const double fade = 1.0 - moment.back;
  const Wrench F = ComputeWrench(holding_, moment.grip, handle, {.f = fade * kept_.f, .t = fade * kept_.t});
  if (moment.clamped) return {.f = F.f, .t = F.t + handle.p_T_head_W.cross(F.f)};

  // along the site's axis the force is at most the script's limit, reduced by push_share_ near the end of the
  // work
  const double max_N = moment.grip * std::lerp(params_.max_force_N, target.force_limit_N, moment.back);
  Vector3 f = LimitAxially(F.f, script_.X_WC().linear().col(2), max_N, push_share_);
  pushed_N_ = std::max(0.0, -script_.X_WC().linear().col(2).dot(f));

  // the whole force is at most the hand's maximum
  const double grip = moment.after_clamp ? std::lerp(1.0, target.grip, moment.back) : target.grip;
  f = LimitNorm(grip * f + script_.X_WC().linear() * moment.jerk_C_N, params_.max_force_N);
  return {.f = f, .t = LimitNorm(grip * F.t + handle.p_T_head_W.cross(f), params_.max_torque_Nm)};
}

OperatorHand::Handle OperatorHand::HandleAt(const HandTarget& target, const Pose& X_WT,
                                            const Twist& V_WT) const noexcept {
  // position of the head's centre relative to T's origin: for the tool and for the target
  const Vector3 p_T_head_W = -script_.head_radius_m() * X_WT.linear().col(2);
  const Vector3 p_T_head_target_W = -script_.head_radius_m() * target.X_WT.linear().col(2);
  Handle handle{.p_T_head_W = p_T_head_W,
                .X = X_WT,
                .X_target = target.X_WT,
                .V = {.v = V_WT.v + V_WT.w.cross(p_T_head_W), .w = V_WT.w},
                .V_target = {.v = target.V_WT.v + target.V_WT.w.cross(p_T_head_target_W), .w = target.V_WT.w},
                .F_mass = {},
                .tremor_N = Vector3::Zero()};
  handle.X.translation() += p_T_head_W;
  handle.X_target.translation() += p_T_head_target_W;
  return handle;
}

double OperatorHand::PushShare(double period_s, const HandTarget& target, const Vector3& p_W_head) noexcept {
  const double head_m = script_.X_WC().linear().col(2).dot(p_W_head - script_.X_WC().translation());
  // height of the simulated tool, which the operator sees: higher than the head by the coupling's deflection
  const double seen_m = head_m + target.give_m_per_N * pushed_N_;
  const double wanted = std::clamp((seen_m - target.done_height_m) / kNearlyDone_m, 0.0, 1.0);
  return push_share_ + period_s / (kSight_s + period_s) * (wanted - push_share_);
}

Wrench OperatorHand::ComputeWrench(std::size_t incident, double grip, const Handle& handle,
                                   const Wrench& kept) const noexcept {
  if (IsClamp(incident)) {
    const Wrench pull = SpringOf(params_.incidents.list[incident]).Pull(handle.X, handle.V, X_W_clamped_, {});
    return {.f = pull.f - handle.F_mass.f, .t = pull.t - handle.F_mass.t};
  }
  const HandSpring spring =
      incident == IncidentMoment::kNone ? params_.spring() : SpringOf(params_.incidents.list[incident]);
  const Wrench pull = spring.Pull(handle.X, handle.V, handle.X_target, handle.V_target);
  return {.f = grip * pull.f - handle.F_mass.f + grip * handle.tremor_N + kept.f,
          .t = grip * pull.t - handle.F_mass.t + kept.t};
}

void OperatorHand::ChangeSpring(const IncidentMoment& moment, double force_limit_N,
                                const Handle& handle) noexcept {
  const bool without_incident = holding_ == IncidentMoment::kNone;
  if (moment.clamped) {
    X_W_clamped_ = handle.X;
    kept_ = {};
  } else {
    // kept_ is the difference between the wrench before the change (limited to its bounds) and the new
    // spring's wrench
    Wrench F_before = ComputeWrench(holding_, moment.grip, handle, without_incident ? Wrench{} : kept_);
    if (without_incident)
      F_before.f = LimitAxially(F_before.f, script_.X_WC().linear().col(2), force_limit_N, push_share_);
    F_before.f = LimitNorm(F_before.f, params_.max_force_N);
    F_before.t = LimitNorm(F_before.t, params_.max_torque_Nm);
    const Wrench F_after = ComputeWrench(moment.holding, moment.grip, handle, {});
    kept_ = {.f = F_before.f - F_after.f, .t = F_before.t - F_after.t};
  }
  holding_ = moment.holding;
}

bool OperatorHand::IsClamp(std::size_t incident) const noexcept {
  return incident != IncidentMoment::kNone &&
         std::holds_alternative<RigidClamp>(params_.incidents.list[incident]);
}

}  // namespace osteon::hil
