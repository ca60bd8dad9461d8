#include "safety/guard_zone.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <stdexcept>
#include <string>

#include "base/number_text.h"

namespace osteon::safety {
namespace {

constexpr double kRotationTolerance = 1e-6;  // tolerance of a rotation matrix

// Signed distance of a point to the surface of a set with perpendicular faces. A gap is the point's signed
// distance from one face, positive outside. A NaN gives NaN, because std::max(x, 0.0) returns a NaN x.
double DistanceFromGaps(std::initializer_list<double> gaps_m) OSTEON_RT {
  double beyond_m2 = 0.0, nearest_m = -std::numeric_limits<double>::infinity();
  for (const double gap_m : gaps_m) {
    const double beyond_m = std::max(gap_m, 0.0);
    beyond_m2 += beyond_m * beyond_m;
    nearest_m = std::max(nearest_m, gap_m);
  }
  return std::sqrt(beyond_m2) + std::min(nearest_m, 0.0);
}

// Signed distance to the surface of the set; negative within.
double SignedDistance_m(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT {
  const Vector3 way_W = p_WP - zone.p_W_m;
  const double x_m = zone.R_W.col(0).dot(way_W), y_m = zone.R_W.col(1).dot(way_W),
               z_m = zone.R_W.col(2).dot(way_W);
  const double beyond_end_m = std::fabs(z_m) - zone.half_length_m;
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      return -z_m;
    case ZoneShape::kSphere:
      return std::hypot(x_m, y_m, z_m) - zone.radius_m;
    case ZoneShape::kCapsule:
      return std::hypot(x_m, y_m, std::max(beyond_end_m, 0.0)) - zone.radius_m;
    case ZoneShape::kCylinder:
      return DistanceFromGaps({std::hypot(x_m, y_m) - zone.radius_m, beyond_end_m});
    case ZoneShape::kBox:
      return DistanceFromGaps({std::fabs(x_m) - zone.half_edge_m.x(), std::fabs(y_m) - zone.half_edge_m.y(),
                               std::fabs(z_m) - zone.half_edge_m.z()});
  }
  return std::numeric_limits<double>::quiet_NaN();  // unknown shape
}

}  // namespace

double GuardZoneMargin_m(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT {
  const double distance_m = SignedDistance_m(zone, p_WP);
  return zone.side == ZoneSide::kKeepIn ? -distance_m : distance_m;
}

void RequireGuardZone(const ZoneParams& zone) {
  const auto require_length = [](const char* name, double found) {
    if (!(found > 0.0) || !std::isfinite(found))
      throw std::invalid_argument("guard: zone: " + std::string(name) + ": found " + base::NumberText(found) +
                                  ", accepted > 0");
  };
  const bool rotation =
      (zone.R_W.transpose() * zone.R_W - Matrix3::Identity()).cwiseAbs().maxCoeff() < kRotationTolerance;
  if (!rotation || !zone.p_W_m.allFinite())
    throw std::invalid_argument("guard: zone: accepted a finite place and unit directions at right angles");
  const bool box = zone.shape == ZoneShape::kBox, half_space = zone.shape == ZoneShape::kHalfSpace;
  if (box)
    for (int i = 0; i < 3; ++i) require_length("half_edge_m", zone.half_edge_m[i]);
  if (!box && !half_space) require_length("radius_m", zone.radius_m);
  if (zone.shape == ZoneShape::kCylinder || zone.shape == ZoneShape::kCapsule)
    require_length("half_length_m", zone.half_length_m);
}

}  // namespace osteon::safety
