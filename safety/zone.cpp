#include "safety/zone.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/number_text.h"
#include "safety/limits.h"

namespace osteon::safety {
namespace {

constexpr double kTiny_m = 1e-12;  // a shorter vector has no usable direction

// Unit vector of v, or `otherwise` if v has no direction.
Vector3 DirectionOr(const Vector3& v, const Vector3& otherwise) OSTEON_RT {
  const double length = v.norm();
  return length > kTiny_m ? Vector3(v / length) : otherwise;
}

// Returns the point of a capsule's axis that is nearest to p; for a sphere, the centre.
Vector3 NearestOfAxis(const ZoneParams& zone, const Vector3& p_Z) OSTEON_RT {
  if (zone.shape == ZoneShape::kSphere) return Vector3::Zero();
  return {0.0, 0.0, std::clamp(p_Z.z(), -zone.half_length_m, zone.half_length_m)};
}

// The nearest point of a set's surface: the unit vector toward the set, and the distance, which is negative
// for a point inside.
struct Outside {
  Vector3 toward_Z;
  double distance_m;
};

// Finds direction and distance from a point to a set with perpendicular faces. gap_m: the point's distance
// from each face, positive outside. out_Z: the faces' outward normals. For a point inside, the nearest face
// is used.
template <std::size_t N>
Outside NearestFromGaps(const std::array<double, N>& gap_m, const std::array<Vector3, N>& out_Z) OSTEON_RT {
  Vector3 beyond = Vector3::Zero();
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < N; ++i) {
    beyond += std::max(0.0, gap_m[i]) * out_Z[i];
    if (gap_m[i] > gap_m[nearest]) nearest = i;
  }
  const double distance_m = beyond.norm();
  if (distance_m > kTiny_m) return {.toward_Z = -beyond / distance_m, .distance_m = distance_m};
  return {.toward_Z = -out_Z[nearest], .distance_m = gap_m[nearest]};
}

}  // namespace

void Validate(const ZoneParams& zone) {
  const auto require = [](bool ok, const std::string& text) {
    if (!ok) throw std::invalid_argument("zone: " + text);
  };
  const auto length = [&](const char* name, double value) {
    require(std::isfinite(value) && value > 0.0,
            std::string(name) + ": found " + base::NumberText(value) + ", accepted > 0");
  };
  require(IsFinite(zone.p_W_m), "p_W_m: accepted finite numbers");
  const bool rotation =
      (zone.R_W * zone.R_W.transpose() - Matrix3::Identity()).norm() < 1e-6 && zone.R_W.determinant() > 0.0;
  require(rotation, "R_W: accepted a rotation");
  if (zone.shape == ZoneShape::kHalfSpace) return;
  if (zone.shape == ZoneShape::kBox) {
    for (int i = 0; i < 3; ++i) length("half_edge_m", zone.half_edge_m[i]);
    return;
  }
  length("radius_m", zone.radius_m);
  if (zone.shape != ZoneShape::kSphere) length("half_length_m", zone.half_length_m);
}

ZoneBounds::ZoneBounds(const ZoneParams& zone, const Vector3& p_WP) OSTEON_RT {
  const Vector3 p_Z = zone.R_W.transpose() * (p_WP - zone.p_W_m);
  if (zone.side == ZoneSide::kKeepIn)
    KeepIn(zone, p_Z);
  else
    KeepOut(zone, p_Z);
  for (std::size_t i = 0; i < count_; ++i) bounds_[i].toward_W = zone.R_W * bounds_[i].toward_W;
}

void ZoneBounds::KeepIn(const ZoneParams& zone, const Vector3& p_Z) OSTEON_RT {
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      return Add(-Vector3::UnitZ(), p_Z.z());
    case ZoneShape::kBox:
      for (int i = 0; i < 3; ++i) {
        Add(Vector3::Unit(i), zone.half_edge_m[i] - p_Z[i]);
        Add(-Vector3::Unit(i), zone.half_edge_m[i] + p_Z[i]);
      }
      return;
    case ZoneShape::kCylinder: {
      const Vector3 across(p_Z.x(), p_Z.y(), 0.0);
      Add(DirectionOr(across, Vector3::UnitX()), zone.radius_m - across.norm());
      Add(Vector3::UnitZ(), zone.half_length_m - p_Z.z());
      return Add(-Vector3::UnitZ(), zone.half_length_m + p_Z.z());
    }
    case ZoneShape::kSphere:
    case ZoneShape::kCapsule: {
      const Vector3 out = p_Z - NearestOfAxis(zone, p_Z);
      return Add(DirectionOr(out, Vector3::UnitX()), zone.radius_m - out.norm());
    }
  }
}

void ZoneBounds::KeepOut(const ZoneParams& zone, const Vector3& p_Z) OSTEON_RT {
  switch (zone.shape) {
    case ZoneShape::kHalfSpace:
      return Add(Vector3::UnitZ(), -p_Z.z());
    case ZoneShape::kBox: {
      std::array<double, 3> gap_m;
      std::array<Vector3, 3> out_Z;
      for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(i);
        gap_m[at] = std::abs(p_Z[i]) - zone.half_edge_m[i];
        out_Z[at] = std::copysign(1.0, p_Z[i]) * Vector3::Unit(i);
      }
      const Outside outside = NearestFromGaps(gap_m, out_Z);
      return Add(outside.toward_Z, outside.distance_m);
    }
    case ZoneShape::kCylinder: {
      const Vector3 across(p_Z.x(), p_Z.y(), 0.0);
      const Outside outside = NearestFromGaps<2>(
          {across.norm() - zone.radius_m, std::abs(p_Z.z()) - zone.half_length_m},
          {DirectionOr(across, Vector3::UnitX()), Vector3(std::copysign(1.0, p_Z.z()) * Vector3::UnitZ())});
      return Add(outside.toward_Z, outside.distance_m);
    }
    case ZoneShape::kSphere:
    case ZoneShape::kCapsule: {
      const Vector3 out = p_Z - NearestOfAxis(zone, p_Z);
      return Add(-DirectionOr(out, Vector3::UnitX()), out.norm() - zone.radius_m);
    }
  }
}

double ZoneBounds::distance_m() const OSTEON_RT {
  double min_m = bounds_[0].distance_m;
  for (std::size_t i = 1; i < count_; ++i) min_m = std::min(min_m, bounds_[i].distance_m);
  return min_m;
}

}  // namespace osteon::safety
