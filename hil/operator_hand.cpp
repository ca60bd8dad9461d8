#include "hil/operator_hand.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <utility>

namespace osteon::hil {
namespace {

// Physiological tremor lies at 8 to 12 Hz.
constexpr std::array<double, 3> kTremorHz{8.3, 9.7, 11.1};

Vector3 Limited(const Vector3& v, double max_size) {
  const double size = v.norm();
  return size > max_size ? Vector3(v * (max_size / size)) : v;
}

}  // namespace

OperatorHand::OperatorHand(const OperatorHandParams& params, HandScript script)
    : params_(params), script_(std::move(script)), impedance_(params) {
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

  // raw bits rather than a distribution: the same phases with every standard library
  std::mt19937_64 bits(params.tremor_seed);
  for (auto& axis : tremor_phase_rad_)
    for (double& phase : axis) phase = 2.0 * std::numbers::pi * static_cast<double>(bits() >> 11) * 0x1p-53;
}

void OperatorHand::Begin() noexcept { impedance_.Begin(); }

Wrench HandImpedance::Step(double period_s, const Pose& X, const Twist& V, const Pose& X_target,
                           const Twist& V_target) noexcept {
  // the mass follows: backward Euler of v_m' = (v - v_m) / tau
  const double share = period_s / (params_.grip_time_s + period_s);
  const Twist dV{.v = share * (V.v - V_mass_.v), .w = share * (V.w - V_mass_.w)};
  V_mass_.v += dV.v;
  V_mass_.w += dV.w;

  const Vector3 turn = X.linear() * LogRotation(X.linear().transpose() * X_target.linear());
  return {.f = params_.stiffness_N_per_m * (X_target.translation() - X.translation()) +
               params_.damping_Ns_per_m * (V_target.v - V.v) - params_.mass_kg / period_s * dV.v,
          .t = params_.stiffness_Nm_per_rad * turn + params_.damping_Nms_per_rad * (V_target.w - V.w) -
               params_.inertia_kgm2 / period_s * dV.w};
}

Wrench OperatorHand::Step(double time_s, double period_s, const Pose& X_WT, const Twist& V_WT) noexcept {
  const HandTarget target = script_.Sample(time_s);
  const Vector3 axis_W = script_.X_WC().linear().col(2);

  // head's centre, of the tool and of the target, relative to T's origin
  const Vector3 p_T_head_W = -script_.head_radius_m() * X_WT.linear().col(2);
  const Vector3 p_T_head_target_W = -script_.head_radius_m() * target.X_WT.linear().col(2);
  Pose X_W_head = X_WT, X_W_head_target = target.X_WT;
  X_W_head.translation() += p_T_head_W;
  X_W_head_target.translation() += p_T_head_target_W;

  // impedance at the head's centre
  const Wrench F = impedance_.Step(
      period_s, X_W_head, {.v = V_WT.v + V_WT.w.cross(p_T_head_W), .w = V_WT.w}, X_W_head_target,
      {.v = target.V_WT.v + target.V_WT.w.cross(p_T_head_target_W), .w = target.V_WT.w});
  Vector3 f = F.f + Tremor(time_s);

  // along the axis the hand presses no harder than the script says
  const double axial_N = axis_W.dot(f);
  f += (std::clamp(axial_N, -target.force_limit_N, target.force_limit_N) - axial_N) * axis_W;

  f = Limited(target.grip * f, params_.max_force_N);
  return {.f = f, .t = Limited(target.grip * F.t + p_T_head_W.cross(f), params_.max_torque_Nm)};
}

Vector3 OperatorHand::Tremor(double time_s) const noexcept {
  Vector3 f = Vector3::Zero();
  if (params_.tremor_N == 0.0) return f;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < kTremorHz.size(); ++i)
      f[static_cast<Eigen::Index>(axis)] +=
          params_.tremor_N / 3.0 *
          std::sin(2.0 * std::numbers::pi * kTremorHz[i] * time_s + tremor_phase_rad_[axis][i]);
  return f;
}

}  // namespace osteon::hil
