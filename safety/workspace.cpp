#include "safety/workspace.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "safety/limits.h"

namespace osteon::safety {

Workspace::Workspace(const WorkspaceParams& params) : params_(params) {
  const auto require = [](bool ok, const std::string& text) {
    if (!ok) throw std::invalid_argument("workspace: " + text);
  };
  require(IsFinite(params.sphere_center_W_m), "sphere_center_W_m is not finite");
  require(std::isfinite(params.sphere_radius_m) && params.sphere_radius_m > 0.0,
          "sphere_radius_m: found " + std::to_string(params.sphere_radius_m) + ", accepted > 0");
  require(std::abs(params.plane_normal_W.norm() - 1.0) < 1e-6,
          "plane_normal_W: found length " + std::to_string(params.plane_normal_W.norm()) + ", accepted 1");
  require(std::isfinite(params.plane_offset_m), "plane_offset_m is not finite");
  require(std::isfinite(params.deceleration_m_per_s2) && params.deceleration_m_per_s2 > 0.0,
          "deceleration_m_per_s2: found " + std::to_string(params.deceleration_m_per_s2) + ", accepted > 0");
  require(std::isfinite(params.tolerance_m) && params.tolerance_m >= 0.0,
          "tolerance_m: found " + std::to_string(params.tolerance_m) + ", accepted >= 0");
}

double Workspace::SphereDistance(const Vector3& p) const OSTEON_RT {
  return params_.sphere_radius_m - (p - params_.sphere_center_W_m).norm();
}

double Workspace::PlaneDistance(const Vector3& p) const OSTEON_RT {
  return params_.plane_normal_W.dot(p) - params_.plane_offset_m;
}

double Workspace::Distance(const Vector3& p_WT) const OSTEON_RT {
  return std::min(SphereDistance(p_WT), PlaneDistance(p_WT));
}

bool Workspace::Violated(const Vector3& p_WT) const OSTEON_RT {
  return !(Distance(p_WT) >= -params_.tolerance_m);
}

Workspace::Result Workspace::Limit(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT {
  if (!IsFinite(p_WT) || !IsFinite(v_WT)) return {.v_WT = Vector3::Zero(), .acted = true};
  Result result{.v_WT = v_WT};

  // the component toward a bound, with the unit vector that points at it
  const auto reduce = [&](const Vector3& toward, double distance) {
    const double excess =
        toward.dot(result.v_WT) - BrakingSpeed(distance, params_.deceleration_m_per_s2, dt_s);
    if (excess <= 0.0) return;
    result.v_WT -= excess * toward;
    result.acted = true;
  };
  const Vector3 radial = p_WT - params_.sphere_center_W_m;
  if (radial.norm() > 1e-9) reduce(radial.normalized(), SphereDistance(p_WT));
  reduce(-params_.plane_normal_W, PlaneDistance(p_WT));

  // what is left over: the other bound's correction, and the sphere's curvature along the step
  const Vector3 p_next = p_WT + dt_s * result.v_WT;
  const auto share_of = [&](double distance, double distance_next) {
    const double approach = (distance - distance_next) / dt_s;
    const double allowed = BrakingSpeed(distance, params_.deceleration_m_per_s2, dt_s);
    return approach > allowed ? allowed / approach : 1.0;
  };
  const double share = std::min(share_of(SphereDistance(p_WT), SphereDistance(p_next)),
                                share_of(PlaneDistance(p_WT), PlaneDistance(p_next)));
  if (share < 1.0) {
    result.v_WT *= share;
    result.acted = true;
  }
  return result;
}

}  // namespace osteon::safety
