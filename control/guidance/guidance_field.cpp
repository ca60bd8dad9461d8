#include "control/guidance/guidance_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::control {
namespace {

constexpr double kMaxDampingShare = 0.25;  // largest damping force / spring force, as in the coupling
constexpr double kPi = std::numbers::pi;

// Throws std::invalid_argument unless the value is within low … high.
void Require(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    throw std::invalid_argument(std::string("guidance ") + name + ": found " + base::NumberText(value) +
                                ", accepted " + base::NumberText(low) + " … " + base::NumberText(high));
}

void RequireSpring(const std::string& name, const GuidanceSpring& spring, double max_stiffness,
                   double max_cap) {
  Require((name + " stiffness").c_str(), spring.stiffness, 0.0, max_stiffness);
  Require((name + " ease").c_str(), spring.ease, 1e-5, 0.1);
  Require((name + " cap").c_str(), spring.cap, 0.5 * spring.stiffness * spring.ease, max_cap);
}

// The spring's force [N or N·m] at an excess that changes at `rate`. If the excess grows, damping × rate is
// added. If it falls, the force is scaled down, to zero at the speed return_rate.
double DampedForce(const GuidanceSpring& spring, double excess, double rate, double damping,
                   double return_rate) OSTEON_RT {
  const double force = SpringForce(spring, excess);
  if (rate >= 0.0) return force + std::min(damping * rate, kMaxDampingShare * force);
  return force * std::max(0.0, 1.0 + rate / return_rate);
}

}  // namespace

void Validate(const GuidanceParams& params) {
  if (!params.centre_W.allFinite() || !(std::abs(params.axis_W.norm() - 1.0) < 1e-9))
    throw std::invalid_argument("guidance: accepted a finite centre and an axis of length 1");
  Require("head_m", params.head_m, 0.0, 0.1);
  Require("gain", params.gain, 0.0, 1.0);
  Require("cone_free_rad", params.cone_free_rad, 1e-3, 0.5 * kPi);
  Require("cone_stop_rad", params.cone_stop_rad, params.cone_free_rad, kPi);
  Require("lateral_free_m", params.lateral_free_m, 0.0, 0.1);
  Require("lateral_stop_m", params.lateral_stop_m, params.lateral_free_m, 0.2);
  Require("widening_rad", params.widening_rad, 0.0, kPi / 3.0);
  Require("depth_soft_m", params.depth_soft_m, -0.1, 0.1);
  RequireSpring("cone", params.cone, kMaxConeStiffness_Nm_per_rad, kMaxConeTorque_Nm);
  RequireSpring("lateral", params.lateral, kMaxLateralStiffness_N_per_m, kMaxLateralForce_N);
  RequireSpring("depth", params.depth, kMaxDepthStiffness_N_per_m, kMaxDepthForce_N);
  Require("return_m_per_s", params.return_m_per_s, 1e-3, 1.0);
  Require("return_rad_per_s", params.return_rad_per_s, 1e-2, 10.0);
  Require("damping_Ns_per_m", params.damping_Ns_per_m, 0.0, 1e4);
  Require("damping_Nms_per_rad", params.damping_Nms_per_rad, 0.0, 1e2);
}

double SpringForce(const GuidanceSpring& spring, double excess) OSTEON_RT {
  const auto& [k, s, cap] = spring;  // s: the spring's ease
  if (!(excess > 0.0)) return 0.0;
  if (excess < s) return 0.5 * k * excess * excess / s;
  return std::min(k * (excess - 0.5 * s), cap);
}

double SpringPotential(const GuidanceSpring& spring, double excess) OSTEON_RT {
  const auto& [k, s, cap] = spring;
  if (!(excess > 0.0) || !(k > 0.0)) return 0.0;
  if (excess < s) return k * excess * excess * excess / (6.0 * s);
  const double at_cap = cap / k + 0.5 * s;  // excess at which the force reaches its cap
  const double linear = std::min(excess, at_cap);
  return k * s * s / 6.0 + 0.5 * k * linear * (linear - s) + cap * std::max(0.0, excess - at_cap);
}

GuidanceField EvaluateGuidance(const GuidanceParams& params, const Pose& X_WT, const Twist& V_WT) OSTEON_RT {
  GuidanceField field;
  // Position of the head and angle of the tool relative to the plan, with the symbols of the header's
  // formulas.
  const Vector3& a = params.axis_W;
  const Vector3 z = X_WT.linear().col(2);
  const Vector3 p_TH = -params.head_m * z;
  const Vector3 v_H = V_WT.v + V_WT.w.cross(p_TH);
  const Vector3 from_centre = X_WT.translation() + p_TH - params.centre_W;
  const double height = a.dot(from_centre);
  const Vector3 r = from_centre - height * a;
  const double rho = r.norm();
  const double cos_psi = std::cos(params.widening_rad), sin_psi = std::sin(params.widening_rad);
  const Vector3 turn = a.cross(z);  // z × -a: a rotation of the tool about this axis reduces the angle
  const double turn_norm = turn.norm();
  const double angle = std::atan2(turn_norm, -a.dot(z));

  GuidanceExcess& e = field.excess;
  e.cone_rad = angle - params.cone_free_rad;
  e.lateral_m = (rho - params.lateral_free_m) * cos_psi - height * sin_psi;
  e.depth_m = params.depth_soft_m - height;
  field.inside = e.cone_rad <= 0.0 && e.lateral_m <= 0.0 && e.depth_m <= 0.0;
  field.beyond_stop =
      angle > params.cone_stop_rad || (rho - params.lateral_stop_m) * cos_psi - height * sin_psi > 0.0;
  field.potential_J = SpringPotential(params.cone, e.cone_rad) +
                      SpringPotential(params.lateral, e.lateral_m) + SpringPotential(params.depth, e.depth_m);
  if (field.inside) return field;

  // damped force of each part; its rate is the speed of the part's excess
  const Vector3 r_unit = rho > 0.0 ? Vector3(r / rho) : Vector3::Zero();
  const Vector3 turn_unit = turn_norm > 0.0 ? Vector3(turn / turn_norm) : Vector3::Zero();
  const Vector3 outward = cos_psi * r_unit - sin_psi * a;  // gradient of e_l
  const double lateral_N = DampedForce(params.lateral, e.lateral_m, outward.dot(v_H), params.damping_Ns_per_m,
                                       params.return_m_per_s);
  const double depth_N =
      DampedForce(params.depth, e.depth_m, -a.dot(v_H), params.damping_Ns_per_m, params.return_m_per_s);
  const double cone_Nm = DampedForce(params.cone, e.cone_rad, -turn_unit.dot(V_WT.w),
                                     params.damping_Nms_per_rad, params.return_rad_per_s);
  field.F_T_W.f = depth_N * a - lateral_N * outward;
  field.f_spring_W =
      SpringForce(params.depth, e.depth_m) * a - SpringForce(params.lateral, e.lateral_m) * outward;
  field.F_T_W.t = cone_Nm * turn_unit + p_TH.cross(field.F_T_W.f);
  return field;
}

}  // namespace osteon::control
