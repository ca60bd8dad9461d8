#include "control/admittance_law.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "control/twist_parts.h"
#include "safety/limits.h"

namespace osteon::control {

void Validate(const AdmittanceParams& params) {
  const auto require = [](const char* name, double value, bool ok, const char* accepted) {
    if (!ok || !std::isfinite(value))
      throw std::invalid_argument(std::string("admittance ") + name + ": found " + std::to_string(value) +
                                  ", accepted " + accepted);
  };
  const auto each = [&](const char* name, const Vector3& v) {
    for (int i = 0; i < 3; ++i) require(name, v[i], v[i] > 0.0, "> 0 on every axis");
  };
  each("mass_kg", params.mass_kg);
  each("inertia_kg_m2", params.inertia_kg_m2);
  each("damping_Ns_per_m", params.damping_Ns_per_m);
  each("damping_Nms_per_rad", params.damping_Nms_per_rad);
  require("dead_zone_N", params.dead_zone_N, params.dead_zone_N >= 0.0, ">= 0");
  require("dead_zone_Nm", params.dead_zone_Nm, params.dead_zone_Nm >= 0.0, ">= 0");
}

Wrench PastDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT {
  const auto shorten = [](const Vector3& v, double zone) -> Vector3 {
    const double size = v.norm();
    if (size <= zone) return Vector3::Zero();
    return (1.0 - zone / size) * v;
  };
  return {.f = shorten(F_T_W.f, params.dead_zone_N), .t = shorten(F_T_W.t, params.dead_zone_Nm)};
}

AdmittanceParams Times(const AdmittanceParams& params, double mass_factor, double damping_factor) OSTEON_RT {
  AdmittanceParams times = params;
  times.mass_kg *= mass_factor;
  times.inertia_kg_m2 *= mass_factor;
  times.damping_Ns_per_m *= damping_factor;
  times.damping_Nms_per_rad *= damping_factor;
  return times;
}

Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT {
  return ratio > 1.0 ? Scaled(V_WT, 1.0 / std::sqrt(ratio)) : V_WT;
}

bool NextTwist(const AdmittanceParams& params, const Pose& X_WT, const Twist& V_WT, const Wrench& F_T_W,
               double dt_s, Twist& V_next_WT) OSTEON_RT {
  const Matrix3 R_WT = X_WT.linear();
  const auto step = [&](const Vector3& v_W, const Vector3& f_W, const Vector3& m,
                        const Vector3& b) -> Vector3 {
    const Vector3 v_T = R_WT.transpose() * v_W;
    const Vector3 f_T = R_WT.transpose() * f_W;
    Vector3 v_next_T;
    for (int i = 0; i < 3; ++i) v_next_T[i] = (v_T[i] + dt_s / m[i] * f_T[i]) / (1.0 + dt_s * b[i] / m[i]);
    return R_WT * v_next_T;
  };
  const Twist next{.v = step(V_WT.v, F_T_W.f, params.mass_kg, params.damping_Ns_per_m),
                   .w = step(V_WT.w, F_T_W.t, params.inertia_kg_m2, params.damping_Nms_per_rad)};
  if (!safety::IsFinite(next)) return false;
  V_next_WT = next;
  return true;
}

Pose Move(const Pose& X_WT, const Twist& V_WT, double dt_s) OSTEON_RT {
  Pose X_next = Pose::Identity();
  X_next.translation() = X_WT.translation() + dt_s * V_WT.v;
  // the quaternion's normalisation takes out what rounding adds to the rotation tick by tick
  const Matrix3 R = ExpRotation(dt_s * V_WT.w) * X_WT.linear();
  X_next.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return X_next;
}

bool StepAdmittance(const AdmittanceParams& params, const Wrench& F_T_W, double dt_s,
                    AdmittanceState& state) OSTEON_RT {
  Twist V_next;
  if (!NextTwist(params, state.X_WT, state.V_WT, F_T_W, dt_s, V_next)) return false;
  const Pose X_next = Move(state.X_WT, V_next, dt_s);
  if (!X_next.matrix().allFinite()) return false;
  state = {.X_WT = X_next, .V_WT = V_next};
  return true;
}

}  // namespace osteon::control
