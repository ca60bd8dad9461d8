#include "safety/depth_limit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parameter_check.h"

namespace osteon::safety {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kMaxDampingShare = 0.25;  // largest ratio of damping force to spring force, as for a contact

// Returns the parameters. If the limit is on, checks them. @throws std::invalid_argument, as Validate
DepthLimitParams Validated(const DepthLimitParams& params) {
  if (params.acts) Validate(params);
  return params;
}

}  // namespace

void Validate(const DepthLimitParams& params) {
  const base::ParameterCheck require("depth limit: ");
  Validate(params.bound);
  require("soft_m", params.soft_m, 1e-5, 1.0);
  require("spindle_stop_m", params.spindle_stop_m, 0.0, params.soft_m);
  require("stiffness_N_per_m", params.stiffness_N_per_m, 1.0, 1e6);
  require("damping_Ns_per_m", params.damping_Ns_per_m, 0.0, 1e5);
}

DepthLimit::DepthLimit(const DepthLimitParams& params) : params_(Validated(params)), distance_m_(kInfinity) {
  params_.bound = ZoneOf(params);
}

Vector3 DepthLimit::Step(const Vector3& p_WT, const Vector3& v_WT, double stiffness_N_per_m) OSTEON_RT {
  if (!params_.acts) return Vector3::Zero();
  const ZoneBounds bounds(params_.bound, p_WT);
  distance_m_ = bounds.distance_m();
  // also true for a distance of NaN: with an unknown position the cut must not continue
  if (!(distance_m_ > params_.spindle_stop_m)) retract_ = true;
  if (distance_m_ >= params_.soft_m) retract_ = false;

  Vector3 f_W = Vector3::Zero();
  for (const ZoneBound& bound : bounds.all()) {
    const double spring_N =
        std::min(params_.stiffness_N_per_m, stiffness_N_per_m) * (params_.soft_m - bound.distance_m);
    if (!(spring_N > 0.0)) continue;
    const double damper_N = params_.damping_Ns_per_m * std::max(0.0, bound.toward_W.dot(v_WT));
    f_W -= (spring_N + std::min(damper_N, kMaxDampingShare * spring_N)) * bound.toward_W;
  }
  return f_W;
}

void DepthLimit::Reset() OSTEON_RT {
  distance_m_ = kInfinity;
  retract_ = false;
}

ZoneParams ZoneOf(const DepthLimitParams& params) {
  ZoneParams zone = params.bound;
  zone.side = ZoneSide::kKeepIn;
  zone.point = ZonePoint::kApex;
  return zone;
}

}  // namespace osteon::safety
