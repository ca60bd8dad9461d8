#include "simulation/solids/shell_solid.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"

namespace osteon::simulation {

ShellSolid::ShellSolid(double inner_m, double outer_m) : inner_m_(inner_m), outer_m_(outer_m) {
  CheckRangeMm("shell: outer radius", outer_m, 1e-3, 1.0);
  CheckRangeMm("shell: inner radius", inner_m, 1e-3, std::nextafter(outer_m, 0.0));
}

SurfacePoint ShellSolid::NearestSurface(const Vector3& p) const {
  // Below the plane of the rim, the nearest point lies on one of three faces; above this plane, on the rim.
  const double size = p.norm();
  const Vector3 out = size > 0.0 ? Vector3(p / size) : Vector3(-Vector3::UnitZ());
  if (p.z() <= 0.0) {
    const double to_outer = size - outer_m_, to_inner = inner_m_ - size, to_rim = p.z();
    if (to_outer > 0.0 || (to_outer >= to_inner && to_outer >= to_rim)) return {outer_m_ * out, to_outer};
    if (to_inner > 0.0 || to_inner >= to_rim) return {inner_m_ * out, to_inner};
    return {Vector3(p.x(), p.y(), 0.0), to_rim};
  }
  const double off_axis = std::hypot(p.x(), p.y());
  const Vector3 radial =
      off_axis > 0.0 ? Vector3(p.x() / off_axis, p.y() / off_axis, 0.0) : Vector3(Vector3::UnitX());
  const Vector3 foot = std::clamp(off_axis, inner_m_, outer_m_) * radial;
  return {foot, (p - foot).norm()};
}

Eigen::AlignedBox3d ShellSolid::Bounds() const {
  return {Vector3(-outer_m_, -outer_m_, -outer_m_), Vector3(outer_m_, outer_m_, 0.0)};
}

}  // namespace osteon::simulation
