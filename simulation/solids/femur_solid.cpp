#include "simulation/solids/femur_solid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check_range.h"
#include "simulation/mesh/shape_mesh.h"

namespace osteon::simulation {
namespace {

// Section at height z. Its sizes change smoothly from those at the saw cut to those of the shaft.
FemurSolid::Section SectionAt(const FemurShape& s, double z_m) {
  // 0 at the saw cut … 1 where the shaft begins, with zero slope at both ends
  const double u = std::clamp(-z_m / s.flare_m, 0.0, 1.0), down = u * u * (3.0 - 2.0 * u);
  const auto between = [down](double top, double shaft) { return top + down * (shaft - top); };
  const double radius_m = between(s.top_radius_m, s.shaft_radius_m);
  const double outer_y_m = 2.0 * radius_m / (1.0 + s.oval_ratio);
  const double shaft_marrow_m =
      2.0 * s.shaft_radius_m / (1.0 + s.oval_ratio) - s.shaft_wall_m - s.shaft_lining_m;
  return {.shift_m = between(s.medial_shift_m, 0.0),
          .outer_x_m = s.oval_ratio * outer_y_m,
          .outer_y_m = outer_y_m,
          .wall_m = between(s.top_wall_m, s.shaft_wall_m),
          .marrow_m = between(s.top_marrow_radius_m, shaft_marrow_m)};
}

}  // namespace

void CheckShape(const FemurShape& s) {
  constexpr double kMin_m = 0.2e-3;  // smallest accepted size of walls and marrow
  CheckRangeMm("femur: length", s.length_m, 0.020, 0.400);
  CheckRangeMm("femur: flare", s.flare_m, 0.005, s.length_m);
  CheckRangeMm("femur: shaft radius", s.shaft_radius_m, 0.005, 0.040);
  CheckRangeMm("femur: top radius", s.top_radius_m, s.shaft_radius_m, 0.060);
  if (!(s.oval_ratio >= 1.0 && s.oval_ratio <= 1.6))
    throw std::invalid_argument(fmt::format("femur: oval_ratio: found {:g}, accepted 1 … 1.6", s.oval_ratio));
  CheckRangeMm("femur: medial shift", s.medial_shift_m, 0.0, 0.5 * s.top_radius_m);
  CheckRangeMm("femur: shaft wall", s.shaft_wall_m, kMin_m, 0.7 * s.shaft_radius_m);
  CheckRangeMm("femur: top wall", s.top_wall_m, kMin_m, 0.5 * s.top_radius_m);
  // space for lining and marrow within the wall, along the shaft's short half axis
  const double room_m = 2.0 * s.shaft_radius_m / (1.0 + s.oval_ratio) - s.shaft_wall_m;
  CheckRangeMm("femur: shaft lining", s.shaft_lining_m, 0.0, room_m - kMin_m);
  CheckRangeMm("femur: top marrow radius", s.top_marrow_radius_m, kMin_m,
               s.top_radius_m - s.top_wall_m - s.medial_shift_m);
}

TriangleMesh FemurMesh(const FemurShape& shape) {
  CheckShape(shape);
  // 96 corners: the widest oval's sides lie within 0.015 mm of it
  constexpr int kCorners = 96;
  constexpr double kStep_m = 2e-3;  // largest height between two rings
  const int steps = static_cast<int>(std::ceil(shape.length_m / kStep_m));
  std::vector<Ring> rings;
  for (int k = 0; k <= steps; ++k) {
    const double z_m = -shape.length_m + shape.length_m * k / steps;
    const FemurSolid::Section section = SectionAt(shape, z_m);
    Ring& ring = rings.emplace_back();
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCorners;
      ring.emplace_back(section.shift_m + section.outer_x_m * std::cos(angle),
                        section.outer_y_m * std::sin(angle), z_m);
    }
  }
  return MeshOfRings(rings);
}

FemurSolid::FemurSolid(const FemurShape& shape) : shape_(shape), mesh_(FemurMesh(shape)) {}

FemurSolid::Section FemurSolid::At(double z_m) const { return SectionAt(shape_, z_m); }

MaterialIndex FemurSolid::MaterialAt(const Vector3& p_m) const {
  const Section section = At(p_m.z());
  const double x = (p_m.x() - section.shift_m) / (section.outer_x_m - section.wall_m);
  const double y = p_m.y() / (section.outer_y_m - section.wall_m);
  if (x * x + y * y > 1.0) return kCortical;
  return std::hypot(p_m.x(), p_m.y()) < section.marrow_m ? kMarrow : kCancellous;
}

}  // namespace osteon::simulation
