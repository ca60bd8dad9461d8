#include "simulation/solids/acetabulum_solid.h"

#include <cmath>

#include "base/check_range.h"

namespace osteon::simulation {
namespace {

constexpr double kMinWall_m = 0.002;  // smallest thickness of the bone beside and below the cup

}  // namespace

void CheckShape(const AcetabulumShape& s) {
  CheckRangeMm("acetabulum: width", s.width_m, 0.010, 0.500);
  CheckRangeMm("acetabulum: height", s.height_m, 0.005, 0.500);
  CheckRangeMm("acetabulum: cup radius", s.cup_radius_m, 0.002,
               std::min(0.5 * s.width_m, s.height_m) - kMinWall_m);
  CheckRangeMm("acetabulum: cartilage thickness", s.cartilage_m, 0.0, 0.020);
  CheckRangeMm("acetabulum: subchondral thickness", s.subchondral_m, 0.0, 0.020);
}

AcetabulumSolid::AcetabulumSolid(const AcetabulumShape& shape)
    : shape_((CheckShape(shape), shape)),
      cup_({.center_m = Vector3(Vector3::Zero()),
            .axis = Vector3(Vector3::UnitZ()),
            .radius_m = shape.cup_radius_m}),
      zone_(cup_),
      block_(Vector3(-0.5 * shape.width_m, -0.5 * shape.width_m, -shape.height_m),
             Vector3(0.5 * shape.width_m, 0.5 * shape.width_m, 0.0)) {}

SurfacePoint AcetabulumSolid::NearestSurface(const Vector3& p_m) const {
  const double R = shape_.cup_radius_m;
  const double from_center = p_m.norm();
  const Vector3 on_sphere =
      from_center > 0.0 ? Vector3(p_m * (R / from_center)) : Vector3(-R * Vector3::UnitZ());

  if (block_.contains(p_m)) {
    // In the cup, the nearest point lies on the sphere: the block's faces are at least as far away as the
    // rim.
    if (from_center < R) return {.p_m = on_sphere, .distance_m = R - from_center};
    // In bone, the nearest point lies on the sphere or on a face of the block. If the foot on the top face
    // lies over the opening, the sphere is nearer in any case.
    SurfacePoint nearest{.p_m = on_sphere, .distance_m = R - from_center};
    for (int axis = 0; axis < 3; ++axis) {
      for (const double wall : {block_.min()[axis], block_.max()[axis]}) {
        const double distance = -std::abs(wall - p_m[axis]);
        if (distance <= nearest.distance_m) continue;
        nearest = {.p_m = p_m, .distance_m = distance};
        nearest.p_m[axis] = wall;
      }
    }
    return nearest;
  }
  // Outside the block: the block's nearest point or, if that point lies over the opening, the nearest point
  // of the rim.
  Vector3 foot = p_m.cwiseMax(block_.min()).cwiseMin(block_.max());
  const double off_axis = std::hypot(foot.x(), foot.y());
  if (p_m.z() > 0.0 && off_axis < R) {
    foot = off_axis > 0.0 ? Vector3(foot.x() * R / off_axis, foot.y() * R / off_axis, 0.0)
                          : Vector3(R, 0.0, 0.0);
  }
  return {.p_m = foot, .distance_m = (p_m - foot).norm()};
}

MaterialIndex AcetabulumSolid::MaterialAt(const Vector3& p_m) const {
  const double depth = zone_.DepthAt(p_m);
  if (depth < shape_.cartilage_m) return kCartilage;
  if (depth < shape_.cartilage_m + shape_.subchondral_m) return kCortical;
  return kCancellous;
}

}  // namespace osteon::simulation
