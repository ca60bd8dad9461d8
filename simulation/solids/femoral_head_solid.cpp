#include "simulation/solids/femoral_head_solid.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "simulation/mesh/shape_mesh.h"

namespace osteon::simulation {
namespace {

constexpr double kMeshStep_m = 1e-3;  // step of the grid on which the mesh is made
constexpr double kFillet_m = 6e-3;    // size of the fillet between head and neck

// Level function, negative inside: the ball and the rod, smoothly joined, without the part beyond the saw
// cut.
double HeadAndNeck(const FemoralHeadShape& s, const Vector3& p_m) {
  const Vector3 down(std::sin(s.neck_tilt_rad), 0.0, -std::cos(s.neck_tilt_rad));
  const double along_m = p_m.dot(down);
  const double head_m = p_m.norm() - s.head_radius_m;
  const double neck_m = (p_m - std::max(0.0, along_m) * down).norm() - s.neck_radius_m;
  // weight of the fillet: 1 where head and neck are equally near, 0 where their distances differ by kFillet_m
  // or more
  const double near = std::max(0.0, 1.0 - std::abs(head_m - neck_m) / kFillet_m);
  const double joined_m = std::min(head_m, neck_m) - 0.25 * kFillet_m * near * near;
  return std::max(joined_m, along_m - s.neck_length_m);
}

// Cartilage, then cortical bone below the surface, then cancellous bone.
TissueMap LayeredTissue(const FemoralHeadShape& s) {
  TissueMap map;
  map.shells = {
      ShellTissue{.layers = {{.material = FemoralHeadSolid::kCartilage, .thickness_m = s.cartilage_m},
                             {.material = FemoralHeadSolid::kCortical, .thickness_m = s.cortical_m}},
                  .core = FemoralHeadSolid::kCancellous,
                  .image = {}}};
  return map;
}

// The outer surface as a mesh without regions.
LoadedMesh Loaded(const FemoralHeadShape& shape) {
  LoadedMesh loaded;
  loaded.mesh = FemoralHeadMesh(shape);
  return loaded;
}

}  // namespace

void CheckShape(const FemoralHeadShape& s) {
  CheckRangeMm("femoral head: head radius", s.head_radius_m, 0.010, 0.040);
  // the neck must be narrower than the head by half the fillet, or no head would remain
  CheckRangeMm("femoral head: neck radius", s.neck_radius_m, 0.005, s.head_radius_m - 0.5 * kFillet_m);
  CheckRangeMm("femoral head: neck length", s.neck_length_m, s.head_radius_m + 0.005, 0.100);
  if (!(s.neck_tilt_rad >= 0.0 && s.neck_tilt_rad <= 1.05))
    throw std::invalid_argument(fmt::format("femoral head: neck tilt: found {:.4g} deg, accepted 0 … 60 deg",
                                            s.neck_tilt_rad * 57.29578));
  CheckRangeMm("femoral head: cartilage", s.cartilage_m, 0.0, 0.005);
  CheckRangeMm("femoral head: cortical", s.cortical_m, 0.0, 0.5 * s.neck_radius_m);
}

TriangleMesh FemoralHeadMesh(const FemoralHeadShape& shape) {
  CheckShape(shape);
  const double reach_m = shape.neck_length_m + shape.neck_radius_m, room_m = 2.0 * kMeshStep_m;
  const Vector3 low(-shape.head_radius_m - room_m, -shape.head_radius_m - room_m, -reach_m - room_m);
  const Vector3 high(reach_m + room_m, shape.head_radius_m + room_m, shape.head_radius_m + room_m);
  return MeshOfLevel([&](const Vector3& p_m) { return HeadAndNeck(shape, p_m); },
                     Eigen::AlignedBox3d(low, high), kMeshStep_m);
}

FemoralHeadSolid::FemoralHeadSolid(const FemoralHeadShape& shape)
    : mesh_(Loaded(shape), LayeredTissue(shape)) {}

}  // namespace osteon::simulation
