#include "control/compliance/bone_mount.h"

#include "base/parameter_check.h"

namespace osteon::control {
namespace {

// Joins translation and rotation into one vector.
Vector6 Joined(const Vector3& linear, const Vector3& angular) OSTEON_RT {
  Vector6 joined;
  joined << linear, angular;
  return joined;
}

// Mass [kg] along each axis, then inertia [kg m²] about each axis.
Vector6 MassOf(const BoneMountParams& p) OSTEON_RT {
  return Joined(Vector3::Constant(p.mass_kg), p.inertia_kg_m2);
}

// Stiffness along each axis [N/m], then about each axis [N·m/rad].
Vector6 StiffnessOf(const BoneMountParams& p) OSTEON_RT {
  return Joined(p.stiffness_N_per_m, p.stiffness_Nm_per_rad);
}

// Present position of Mo in W: at rest, plus the displacements of springs and pads.
Vector3 PlaceOf(const BoneMountParams& p, const BoneMountState& s) OSTEON_RT {
  return p.p_WMo_m + s.d.head<3>() + s.creep_m;
}

}  // namespace

void Validate(const BoneMountParams& params) {
  const base::ParameterCheck require("compliance mount ");
  require("mass_kg", params.mass_kg, 0.01, 1000.0);
  for (int i = 0; i < 3; ++i) {
    require("p_WMo_m", params.p_WMo_m[i], -10.0, 10.0);
    require("inertia_kg_m2", params.inertia_kg_m2[i], 1e-5, 1000.0);
    require("stiffness_N_per_m", params.stiffness_N_per_m[i], 10.0, 1e8);
    require("stiffness_Nm_per_rad", params.stiffness_Nm_per_rad[i], 0.1, 1e7);
  }
  require("damping_ratio", params.damping_ratio, 0.0, 10.0);
  require("creep_N_per_m", params.creep_N_per_m, 0.0, 1e9);
  require("creep_tau_s", params.creep_tau_s, 1e-3, 1e6);
  require("max_shift_m", params.max_shift_m, 1e-5, 1.0);
  require("max_turn_rad", params.max_turn_rad, 1e-5, 1.0);
}

void StepMount(const BoneMountParams& params, const Wrench& F_Mo_W, double period_s,
               BoneMountState& state) OSTEON_RT {
  const Vector6 M = MassOf(params), K = StiffnessOf(params);
  const Vector6 D = 2.0 * params.damping_ratio * (K.cwiseProduct(M)).cwiseSqrt();
  const Vector6 F = Joined(F_Mo_W.f, F_Mo_W.t);
  state.v =
      (M.cwiseProduct(state.v) - period_s * (F + K.cwiseProduct(state.d))).cwiseQuotient(M + period_s * D);
  state.d += period_s * state.v;
  if (!(params.creep_N_per_m > 0.0)) return;  // the pads do not creep
  const Vector3 before_m = state.creep_m;
  state.creep_m = StepMassless<3>(before_m, -F_Mo_W.f / params.creep_N_per_m, period_s, params.creep_tau_s);
  state.creep_m_per_s = (state.creep_m - before_m) / period_s;
}

Pose MountPose(const BoneMountParams& params, const BoneMountState& state) OSTEON_RT {
  Pose X_WM = Pose::Identity();
  X_WM.linear() = ExpRotation(state.d.tail<3>());
  X_WM.translation() = PlaceOf(params, state) - X_WM.linear() * params.p_WMo_m;
  return X_WM;
}

Twist MountTwistAt(const BoneMountParams& params, const BoneMountState& state, const Vector3& p_W) OSTEON_RT {
  const Vector3 w = state.v.tail<3>();
  return {.v = state.v.head<3>() + state.creep_m_per_s + w.cross(p_W - PlaceOf(params, state)), .w = w};
}

}  // namespace osteon::control
