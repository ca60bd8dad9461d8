#include "simulation/solids/box_solid.h"

#include <cmath>

#include "base/check_range.h"

namespace osteon::simulation {
namespace {

constexpr double kMinSide_m = 0.1e-3, kMaxSide_m = 1.0;

}  // namespace

BoxSolid::BoxSolid(const Vector3& low_m, const Vector3& high_m, std::vector<TissueLayer> layers,
                   MaterialIndex core)
    : box_(low_m, high_m), layers_(std::move(layers)), core_(core) {
  const Vector3 sides = high_m - low_m;
  for (int axis = 0; axis < 3; ++axis)
    CheckRangeMm(fmt::format("box: side along {}", "xyz"[axis]), sides[axis], kMinSide_m, kMaxSide_m);
  for (std::size_t i = 0; i < layers_.size(); ++i)
    CheckRangeMm(fmt::format("box: thickness of layer {}", i + 1), layers_[i].thickness_m, 0.0, kMaxSide_m);
}

BoxSolid::BoxSolid(const BlockShape& shape)
    : BoxSolid((CheckShape(shape), Vector3(-0.5 * shape.width_m, -0.5 * shape.depth_m, -shape.height_m)),
               Vector3(0.5 * shape.width_m, 0.5 * shape.depth_m, 0.0), shape.layers, shape.core) {}

SurfacePoint BoxSolid::NearestSurface(const Vector3& p_m) const {
  if (!box_.contains(p_m)) {
    const Vector3 foot = p_m.cwiseMax(box_.min()).cwiseMin(box_.max());
    return {.p_m = foot, .distance_m = (p_m - foot).norm()};
  }
  SurfacePoint nearest{.p_m = p_m, .distance_m = -kMaxSide_m};
  for (int axis = 0; axis < 3; ++axis)
    for (const double wall : {box_.min()[axis], box_.max()[axis]}) {
      const double distance = -std::abs(wall - p_m[axis]);
      if (distance <= nearest.distance_m) continue;
      nearest = {.p_m = p_m, .distance_m = distance};
      nearest.p_m[axis] = wall;
    }
  return nearest;
}

MaterialIndex BoxSolid::MaterialAt(const Vector3& p_m) const {
  const double depth_m = box_.max().z() - p_m.z();
  double bottom_m = 0.0;
  for (const TissueLayer& layer : layers_) {
    bottom_m += layer.thickness_m;
    if (depth_m < bottom_m) return layer.material;
  }
  return core_;
}

void CheckShape(const BlockShape& s) {
  CheckRangeMm("block: width", s.width_m, kMinSide_m, 0.500);
  CheckRangeMm("block: depth", s.depth_m, kMinSide_m, 0.500);
  CheckRangeMm("block: height", s.height_m, kMinSide_m, 0.500);
  double layers_m = 0.0;
  for (const TissueLayer& layer : s.layers) layers_m += layer.thickness_m;
  CheckRangeMm("block: layers, in all", layers_m, 0.0, s.height_m);
}

}  // namespace osteon::simulation
