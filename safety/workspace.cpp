#include "safety/workspace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "safety/limits.h"

namespace osteon::safety {
namespace {

// most corrections of a velocity whose stop would end outside; for a plane one is enough
constexpr int kCorrections = 6;
// a corrected stop ends this far inside the bound; larger than rounding errors
constexpr double kInside_m = 1e-12;
constexpr int kHalvings = 12;  // steps of each bisection in StoppingInside
// Tolerances of Allows: a velocity from Limit is converted to joint velocities and back, which adds rounding
// errors.
constexpr double kRounding_m_per_s = 1e-8, kRounding_m = 1e-10;

}  // namespace

Workspace::Workspace(const WorkspaceParams& params) : params_(params) {
  const auto require = [](bool ok, const std::string& text) {
    if (!ok) throw std::invalid_argument("workspace: " + text);
  };
  require(IsFinite(params.sphere_center_W_m), "sphere_center_W_m is not finite");
  require(std::isfinite(params.sphere_radius_m) && params.sphere_radius_m > 0.0,
          "sphere_radius_m: found " + base::NumberText(params.sphere_radius_m) + ", accepted > 0");
  require(std::abs(params.plane_normal_W.norm() - 1.0) < 1e-6,
          "plane_normal_W: found length " + base::NumberText(params.plane_normal_W.norm()) + ", accepted 1");
  require(std::isfinite(params.plane_offset_m), "plane_offset_m is not finite");
  require(
      std::isfinite(params.deceleration_m_per_s2) && params.deceleration_m_per_s2 > 0.0,
      "deceleration_m_per_s2: found " + base::NumberText(params.deceleration_m_per_s2) + ", accepted > 0");
  require(std::isfinite(params.tolerance_m) && params.tolerance_m >= 0.0,
          "tolerance_m: found " + base::NumberText(params.tolerance_m) + ", accepted >= 0");
  require(params.zones.size() <= kMaxZones, "zones: found " + std::to_string(params.zones.size()) +
                                                ", accepted at most " + std::to_string(kMaxZones));

  std::vector<ZoneParams>& apex = bounds_[static_cast<std::size_t>(ZonePoint::kApex)];
  apex.push_back(
      {.shape = ZoneShape::kSphere, .p_W_m = params.sphere_center_W_m, .radius_m = params.sphere_radius_m});
  apex.push_back({.shape = ZoneShape::kHalfSpace,
                  .p_W_m = params.plane_offset_m * params.plane_normal_W,
                  .R_W = RotationFromZTo(params.plane_normal_W)});
  for (const ZoneParams& zone : params.zones) {
    Validate(zone);
    bounds_[static_cast<std::size_t>(zone.point)].push_back(zone);
  }
}

double Workspace::Distance(const Vector3& p_WP, ZonePoint point) const OSTEON_RT {
  double min_m = std::numeric_limits<double>::infinity();
  for (const ZoneParams& zone : Bounds(point)) min_m = std::min(min_m, ZoneBounds(zone, p_WP).distance_m());
  return min_m;
}

bool Workspace::Violated(const Vector3& p_WP, ZonePoint point) const OSTEON_RT {
  return !IsFinite(p_WP) || !(Distance(p_WP, point) >= -params_.tolerance_m);
}

Workspace::Result Workspace::Limit(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT {
  if (!IsFinite(p_WT) || !IsFinite(v_WT)) return {.v_WT = Vector3::Zero(), .acted = true};
  Result result{.v_WT = v_WT};
  for (const ZoneParams& zone : Bounds(ZonePoint::kApex)) {
    const ZoneBounds bounds(zone, p_WT);
    for (const ZoneBound& bound : bounds.all()) {
      const double excess = bound.toward_W.dot(result.v_WT) -
                            BrakingSpeed(bound.distance_m, params_.deceleration_m_per_s2, dt_s);
      if (excess <= 0.0) continue;
      result.v_WT -= excess * bound.toward_W;
      result.acted = true;
    }
  }
  // the stop may still end outside: later corrections may undo earlier ones, a bound may be curved, and a
  // bound may be approached at a slant
  if (StopsInside(p_WT, result.v_WT, dt_s)) return result;
  return {.v_WT = StoppingInside(p_WT, result.v_WT, dt_s), .acted = true};
}

Vector3 Workspace::StoppingInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT {
  // bisect the time ahead over which the velocity is turned: fails_s is too short, stops_s is long enough
  double fails_s = dt_s, stops_s = StopTime(v_WT, dt_s);
  Vector3 turned_WT = TurnedInside(p_WT, v_WT, stops_s);
  if (StopsInside(p_WT, turned_WT, dt_s)) {
    for (int i = 0; i < kHalvings; ++i) {  // a turned velocity is slower than v and stops earlier, so try
                                           // shorter times to find the fastest one
      const double look_s = 0.5 * (fails_s + stops_s);
      const Vector3 faster_WT = TurnedInside(p_WT, v_WT, look_s);
      const bool stops = StopsInside(p_WT, faster_WT, dt_s);
      (stops ? stops_s : fails_s) = look_s;
      if (stops) turned_WT = faster_WT;
    }
    return turned_WT;
  }
  // turning is not enough: find by bisection the largest share of the whole velocity that stops inside
  double stops = 0.0, fails = 1.0;
  for (int i = 0; i < kHalvings; ++i) {
    const double share = 0.5 * (stops + fails);
    (StopsInside(p_WT, share * v_WT, dt_s) ? stops : fails) = share;
  }
  return stops * v_WT;
}

// For each bound beyond which the stop would end, removes from the velocity the excess along the bound's
// normal at the stop's end. Scaling the whole velocity instead would cause chatter while a hand pushes,
// because the removed motion along the bound would come back within a few ticks.
Vector3 Workspace::TurnedInside(const Vector3& p_WT, const Vector3& v_WT, double look_s) const OSTEON_RT {
  Vector3 turned_WT = v_WT;
  bool ends_inside = false;
  for (int i = 0; i < kCorrections && !ends_inside; ++i) {
    ends_inside = true;
    for (const ZoneParams& zone : Bounds(ZonePoint::kApex)) {
      const bool keep_in = zone.side == ZoneSide::kKeepIn;
      const Vector3 way = look_s * turned_WT;
      const ZoneBounds here(zone, p_WT), there(zone, keep_in ? Vector3(p_WT + way) : p_WT);
      for (std::size_t k = 0; k < here.all().size(); ++k) {
        const double distance_m = here.all()[k].distance_m;
        const ZoneBound& end = there.all()[k];
        // left_m: distance to the bound at the end; lacks_m: how much it is short of 0. A point that is
        // already outside may stay as far outside.
        const double left_m = keep_in ? end.distance_m : distance_m - end.toward_W.dot(way);
        const double lacks_m = std::min(0.0, distance_m) - left_m;
        if (!(lacks_m > 0.0)) continue;
        turned_WT -= (lacks_m + kInside_m) / look_s * end.toward_W;
        ends_inside = false;
      }
    }
  }
  return turned_WT;
}

bool Workspace::Allows(const Vector3& p_WT, const Vector3& v_WT, double dt_s) const OSTEON_RT {
  if (!IsFinite(p_WT) || !IsFinite(v_WT)) return false;
  for (const ZoneParams& zone : Bounds(ZonePoint::kApex)) {
    const ZoneBounds bounds(zone, p_WT);
    for (const ZoneBound& bound : bounds.all())
      if (bound.toward_W.dot(v_WT) >
          BrakingSpeed(bound.distance_m, params_.deceleration_m_per_s2, dt_s) + kRounding_m_per_s)
        return false;
  }
  return StopsInside(p_WT, v_WT, dt_s, kRounding_m);
}

// A keep-out set is replaced by the half-space that touches it at the point nearest to p.
bool Workspace::StopsInside(const Vector3& p_WT, const Vector3& v_WT, double dt_s,
                            double slack_m) const OSTEON_RT {
  const Vector3 way = StopTime(v_WT, dt_s) * v_WT;
  return std::all_of(Bounds(ZonePoint::kApex).begin(), Bounds(ZonePoint::kApex).end(),
                     [&](const ZoneParams& zone) {
                       const ZoneBounds bounds(zone, p_WT);
                       const double distance_m = bounds.distance_m();
                       const double left_m = zone.side == ZoneSide::kKeepIn
                                                 ? ZoneBounds(zone, p_WT + way).distance_m()
                                                 : distance_m - bounds.all().front().toward_W.dot(way);
                       // a point that is outside already may stay as far outside
                       return left_m >= std::min(0.0, distance_m) - slack_m;
                     });
}

// The distance to the bound of a keep-in set is concave along a displacement, so the share s of the
// displacement reduces it by at most s times the whole reduction. The distance to a keep-out set is convex,
// so the share s reduces it by at most s times the reduction predicted by its slope.
double Workspace::Share(ZonePoint point, const Vector3& p_WP, const Vector3& p_next_WP,
                        double dt_s) const OSTEON_RT {
  if (!IsFinite(p_WP) || !IsFinite(p_next_WP)) return 0.0;
  double share = 1.0;
  for (const ZoneParams& zone : Bounds(point)) {
    const ZoneBounds bounds(zone, p_WP);
    const double distance_m = bounds.distance_m();
    const double nearer_m = zone.side == ZoneSide::kKeepIn
                                ? distance_m - ZoneBounds(zone, p_next_WP).distance_m()
                                : bounds.all().front().toward_W.dot(p_next_WP - p_WP);
    const double allowed_m = dt_s * BrakingSpeed(distance_m, params_.deceleration_m_per_s2, dt_s);
    if (nearer_m > allowed_m) share = std::min(share, allowed_m / nearer_m);
  }
  return share;
}

bool Workspace::LeavesZone(ZonePoint point, const Vector3& p_WP, const Vector3& p_next_WP) const OSTEON_RT {
  const std::size_t own = point == ZonePoint::kApex ? kOwn : 0;
  const std::vector<ZoneParams>& bounds = Bounds(point);
  for (std::size_t i = own; i < bounds.size(); ++i) {
    const double next_m = ZoneBounds(bounds[i], p_next_WP).distance_m();
    if (!(next_m >= -params_.tolerance_m) && !(next_m >= ZoneBounds(bounds[i], p_WP).distance_m()))
      return true;
  }
  return false;
}

}  // namespace osteon::safety
