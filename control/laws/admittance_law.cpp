#include "control/laws/admittance_law.h"

#include <cmath>

#include "base/parameter_check.h"
#include "control/laws/twist_parts.h"
#include "safety/limits.h"

namespace osteon::control {
namespace {

constexpr double kMaxCentre_m = 10.0;  // largest accepted coordinate of the centre, in magnitude

// Converts an inertia or drag that is diagonal at C to the 6x6 matrix at To, in T: A^T diag(linear, angular)
// A with A = [1 -c×; 0 1].
// @param c  vector from To to C, in T
Matrix6 AtOrigin(const Vector3& linear, const Vector3& angular, const Vector3& c) {
  Matrix3 c_cross;
  c_cross << 0.0, -c.z(), c.y(), c.z(), 0.0, -c.x(), -c.y(), c.x(), 0.0;
  Matrix6 A = Matrix6::Identity();
  A.topRightCorner<3, 3>() = -c_cross;
  Eigen::Matrix<double, 6, 1> at_centre;
  at_centre << linear, angular;
  return A.transpose() * at_centre.asDiagonal() * A;
}

}  // namespace

void Validate(const AdmittanceParams& params) {
  const base::ParameterCheck require("admittance ");
  const auto each = [&](const char* name, const Vector3& v) {
    for (int i = 0; i < 3; ++i) require(name, v[i], v[i] > 0.0, "> 0 on every axis");
  };
  each("mass_kg", params.mass_kg);
  each("inertia_kg_m2", params.inertia_kg_m2);
  each("damping_Ns_per_m", params.damping_Ns_per_m);
  each("damping_Nms_per_rad", params.damping_Nms_per_rad);
  require("dead_zone_N", params.dead_zone_N, params.dead_zone_N >= 0.0, ">= 0");
  require("dead_zone_Nm", params.dead_zone_Nm, params.dead_zone_Nm >= 0.0, ">= 0");
  for (int i = 0; i < 3; ++i)
    require("centre_T_m", params.centre_T_m[i], std::abs(params.centre_T_m[i]) <= kMaxCentre_m,
            "-10 … 10 on every axis");
}

Wrench SubtractDeadZone(const AdmittanceParams& params, const Wrench& F_T_W) OSTEON_RT {
  const auto shorten = [](const Vector3& v, double zone) -> Vector3 {
    const double size = v.norm();
    if (size <= zone) return Vector3::Zero();
    return (1.0 - zone / size) * v;
  };
  return {.f = shorten(F_T_W.f, params.dead_zone_N), .t = shorten(F_T_W.t, params.dead_zone_Nm)};
}

AdmittanceParams ScaleLaw(const AdmittanceParams& params, double mass_factor,
                          double damping_factor) OSTEON_RT {
  AdmittanceParams scaled = params;
  scaled.mass_kg *= mass_factor;
  scaled.inertia_kg_m2 *= mass_factor;
  scaled.damping_Ns_per_m *= damping_factor;
  scaled.damping_Nms_per_rad *= damping_factor;
  return scaled;
}

Twist AfterMassChange(const Twist& V_WT, double ratio) OSTEON_RT {
  return ratio > 1.0 ? Scaled(V_WT, 1.0 / std::sqrt(ratio)) : V_WT;
}

Twist AfterMassChange(const AdmittanceParams& before, const AdmittanceParams& after, const Matrix3& R_WT,
                      const Twist& V_WT) OSTEON_RT {
  const auto slower = [](const Vector3& v, const Vector3& m_before, const Vector3& m_after) -> Vector3 {
    return v.cwiseProduct(m_before.cwiseQuotient(m_after).cwiseMin(1.0).cwiseSqrt());
  };
  const Vector3 w_T = R_WT.transpose() * V_WT.w;
  const Vector3 v_C = R_WT.transpose() * V_WT.v + w_T.cross(before.centre_T_m);
  const Vector3 w_after_T = slower(w_T, before.inertia_kg_m2, after.inertia_kg_m2);
  const Vector3 v_after_C = slower(v_C, before.mass_kg, after.mass_kg);
  return {.v = R_WT * (v_after_C - w_after_T.cross(after.centre_T_m)), .w = R_WT * w_after_T};
}

Matrix6 MassMatrix(const AdmittanceParams& params) {
  return AtOrigin(params.mass_kg, params.inertia_kg_m2, params.centre_T_m);
}

Matrix6 DampingMatrix(const AdmittanceParams& params) {
  return AtOrigin(params.damping_Ns_per_m, params.damping_Nms_per_rad, params.centre_T_m);
}

bool NextTwist(const AdmittanceParams& params, const NextTwistInput& input, Twist& V_next_WT) OSTEON_RT {
  const Twist& V_WT = input.V_WT;
  const Wrench& F_T_W = input.F_T_W;
  const Twist& V_held_C = input.V_held_C;
  const double dt_s = input.dt_s;
  const Matrix3 R_WT = input.X_WT.linear();
  const Vector3& c = params.centre_T_m;
  const bool at_origin = c.isZero(0.0);
  // express velocity and wrench in T, then refer them to C
  Twist V_T{.v = R_WT.transpose() * V_WT.v, .w = R_WT.transpose() * V_WT.w};
  Wrench F_T{.f = R_WT.transpose() * F_T_W.f, .t = R_WT.transpose() * F_T_W.t};
  if (!at_origin) {
    V_T.v += V_T.w.cross(ExpRotation(-dt_s * V_T.w) * c);
    F_T.t -= c.cross(F_T.f);
  }

  // One implicit step of three axes. A locked axis gets the velocity given for it.
  const auto step = [&](const Vector3& v, const Vector3& f, const Vector3& m, const Vector3& b,
                        const Vector3& held, std::size_t first) -> Vector3 {
    Vector3 v_next;
    for (int i = 0; i < 3; ++i)
      v_next[i] = params.locked[first + static_cast<std::size_t>(i)]
                      ? held[i]
                      : (v[i] + dt_s / m[i] * f[i]) / (1.0 + dt_s * b[i] / m[i]);
    return v_next;
  };
  Vector3 v_next_T = step(V_T.v, F_T.f, params.mass_kg, params.damping_Ns_per_m, V_held_C.v, 0);
  const Vector3 w_next_T =
      step(V_T.w, F_T.t, params.inertia_kg_m2, params.damping_Nms_per_rad, V_held_C.w, 3);
  if (!at_origin) v_next_T -= w_next_T.cross(c);

  const Twist next{.v = R_WT * v_next_T, .w = R_WT * w_next_T};
  if (!safety::IsFinite(next)) return false;
  V_next_WT = next;
  return true;
}

Pose IntegratePose(const Pose& X_WT, const Twist& V_WT, double dt_s) OSTEON_RT {
  Pose X_next = Pose::Identity();
  X_next.translation() = X_WT.translation() + dt_s * V_WT.v;
  // converting to a normalised quaternion removes the rounding error that would accumulate in the rotation
  const Matrix3 R = ExpRotation(dt_s * V_WT.w) * X_WT.linear();
  X_next.linear() = Eigen::Quaterniond(R).normalized().toRotationMatrix();
  return X_next;
}

bool StepAdmittance(const AdmittanceParams& params, const Wrench& F_T_W, double dt_s,
                    AdmittanceState& state) OSTEON_RT {
  Twist V_next;
  if (!NextTwist(params, {.X_WT = state.X_WT, .V_WT = state.V_WT, .F_T_W = F_T_W, .dt_s = dt_s}, V_next))
    return false;
  const Pose X_next = IntegratePose(state.X_WT, V_next, dt_s);
  if (!X_next.matrix().allFinite()) return false;
  state = {.X_WT = X_next, .V_WT = V_next};
  return true;
}

}  // namespace osteon::control
