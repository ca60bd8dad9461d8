#include "simulation/solids/molar_solid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check_range.h"
#include "simulation/mesh/shape_mesh.h"

namespace osteon::simulation {
namespace {

// All shapes below are for a tooth of 20.6 mm, in millimetres. The functions of p are level functions:
// negative inside, zero on the surface.
constexpr double kLength_mm = 20.6, kCrown_mm = 7.2, kRoot_mm = kLength_mm - kCrown_mm;

/// Position of a cusp's top, and its height above the bowl of the occlusal surface.
struct Cusp {
  double x, y, height;
};
constexpr std::array<Cusp, 4> kCusps{
    {{2.7, 2.3, 1.85}, {2.7, -2.3, 1.75}, {-2.6, 2.3, 1.65}, {-2.6, -2.3, 1.6}}};

/// Smooth minimum: the smaller of both values, rounded off if they differ by less than `reach`.
double SmoothMin(double a, double b, double reach) {
  const double h = std::max(reach - std::abs(a - b), 0.0) / reach;
  return std::min(a, b) - 0.25 * reach * h * h;
}
double SmoothMax(double a, double b, double reach) { return -SmoothMin(-a, -b, reach); }

/// Value of a bell curve of height 1 at the squared distance `distance2` from its centre.
double Bump(double distance2, double width) { return std::exp(-0.5 * distance2 / (width * width)); }

/// Height of the occlusal surface: cusps over a bowl, less the fissures between them.
double Occlusal(double x, double y) {
  double z = 5.35;
  for (const Cusp& cusp : kCusps) {
    const double dx = x - cusp.x, dy = y - cusp.y;
    z += cusp.height * Bump(dx * dx + dy * dy, 1.35);
  }
  // the fissures fade towards the rim
  const double rim = std::max(0.0, 1.0 - (x * x + y * y) / 25.0);
  return z - rim * (0.55 * Bump(y * y, 0.38) + 0.45 * Bump(x * x, 0.38));
}

/// The body of the tooth: crown, neck and the trunk above the roots.
double Body(const Vector3& p) {
  // half widths a and b along x and y: they bulge in the crown and are small at the neck
  const double u = std::clamp(p.z() / kCrown_mm, -0.6, 1.1);
  const double bulge = u > 0.0 ? std::sin(std::min(u, 1.0) * 2.6) : 0.9 * u;
  const double a = 4.55 + 0.85 * bulge, b = 4.15 + 0.85 * bulge;
  // exponent of the outline, whose shape is between an ellipse (2) and a rectangle (infinite)
  constexpr double kSquare = 2.6;
  const double across = std::pow(std::abs(p.x()) / a, kSquare) + std::pow(std::abs(p.y()) / b, kSquare);
  const double below = p.z() < 0.0 ? std::pow(p.z() / -4.6, 4.0) : 0.0;
  const double side = (std::pow(across + below, 1.0 / kSquare) - 1.0) * std::min(a, b);
  return SmoothMax(side, p.z() - Occlusal(p.x(), p.y()), 1.2);
}

/// Point on a root's axis at the fraction t of the root's length; front = +1 or -1. The roots spread and bend
/// backwards.
Vector3 RootAxis(double front, double t) {
  const double x = front * (2.35 + 1.5 * t) - 1.6 * t * t;
  return {x, 0.0, -kRoot_mm * t};
}

/// The front (+1) or the back (-1) root.
double Root(const Vector3& p, double front) {
  const double t = std::clamp(-p.z() / kRoot_mm, -0.1, 1.2);
  const Vector3 axis = RootAxis(front, t);
  // half widths a along x (narrow) and b along y (wide); the root tapers, and is round at the tip
  const double a = 1.95 - 0.95 * t, b = 3.7 - 2.0 * t;
  const double dx = (p.x() - axis.x()) / a, dy = p.y() / b;
  const double tip = t > 0.0 ? std::pow(-p.z() / kRoot_mm, 8.0) : 0.0;
  const double above = p.z() > 0.0 ? p.z() : 0.0;  // makes the root end inside the body
  return (std::sqrt(dx * dx + dy * dy + tip) - 1.0) * a + above;
}

/// The whole outer surface: body and both roots.
double Tooth(const Vector3& p) {
  const double roots = SmoothMin(Root(p, 1.0), Root(p, -1.0), 0.6);
  return SmoothMin(Body(p), roots, 1.2);
}

/// A rod that narrows from one end to the other.
double Rod(const Vector3& p, const Vector3& from, const Vector3& to, double from_radius, double to_radius) {
  const Vector3 axis = to - from;
  const double s = std::clamp((p - from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  return (p - from - s * axis).norm() - (from_radius + s * (to_radius - from_radius));
}

/// The pulp: chamber, a horn under each cusp, and three canals. @param width  MolarShape::pulp_width
double Pulp(const Vector3& p, double width) {
  // chamber: a rounded box at the height of the neck
  const Vector3 half(2.0 * width, 1.6 * width, 0.75);
  constexpr double kRounding = 0.5;
  const Vector3 q = (p - Vector3(0.0, 0.0, -0.2)).cwiseAbs() - half;
  double level = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0) - kRounding;
  for (const Cusp& cusp : kCusps) {
    const Vector3 from(0.68 * cusp.x * width, 0.62 * cusp.y * width, 0.2),
        to(0.78 * cusp.x, 0.74 * cusp.y, 2.3);
    level = SmoothMin(level, Rod(p, from, to, 0.55 * width, 0.22), 0.4);
  }
  struct Canal {
    double front, y;
  };
  for (const Canal& canal : {Canal{1.0, 1.0}, Canal{1.0, -1.0}, Canal{-1.0, 0.0}}) {
    constexpr int kPieces = 6;
    constexpr double kFrom = 0.08, kTo = 0.87;  // ends of a canal, as fractions of the root's length
    const auto at = [&](int i) {
      const double s = static_cast<double>(i) / kPieces, t = kFrom + s * (kTo - kFrom);
      Vector3 place = RootAxis(canal.front, t);
      place.x() += canal.front * -0.7 * (1.0 - s) *
                   (1.0 - s);  // shifts the upper end of the canal to the chamber's floor
      place.y() = canal.y * (1.0 - 0.55 * s);
      return place;
    };
    const auto radius = [&](int i) { return (0.48 - 0.22 * i / kPieces) * width; };
    for (int i = 0; i < kPieces; ++i)
      level = SmoothMin(level, Rod(p, at(i), at(i + 1), radius(i), radius(i + 1)), 0.2);
  }
  return level;
}

/// Tissue map without enamel: dentine within the outer surface, pulp within the region.
TissueMap DentineAndPulp() {
  TissueMap map;
  map.shells = {ShellTissue{.layers = {}, .core = MolarSolid::kDentine, .image = {}},
                ShellTissue{.layers = {}, .core = MolarSolid::kPulp, .image = {}}};
  return map;
}

}  // namespace

void CheckShape(const MolarShape& s) {
  CheckRangeMm("molar: length", s.length_m, 0.010, 0.040);
  CheckRangeMm("molar: enamel thickness", s.enamel_m, 0.0, 0.12 * s.length_m);
  if (!(s.pulp_width >= 0.6 && s.pulp_width <= 1.3))
    throw std::invalid_argument(
        fmt::format("molar: pulp_width: found {:g}, accepted 0.6 … 1.3", s.pulp_width));
}

LoadedMesh MolarMesh(const MolarShape& shape) {
  CheckShape(shape);
  const double scale = shape.length_m / kLength_mm;  // metres per millimetre of the shapes above
  const Eigen::AlignedBox3d box(scale * Vector3(-7.3, -6.7, -14.2), scale * Vector3(7.3, 6.7, 8.3));
  constexpr double kStep_mm = 0.35, kPulpStep_mm = 0.2;
  LoadedMesh loaded;
  loaded.mesh = MeshOfLevel([&](const Vector3& p) { return Tooth(p / scale); }, box, scale * kStep_mm);
  MeshRegion& pulp = loaded.regions.emplace_back();
  pulp.name = "pulp";
  pulp.mesh = MeshOfLevel([&](const Vector3& p) { return Pulp(p / scale, shape.pulp_width); }, box,
                          scale * kPulpStep_mm);
  return loaded;
}

MolarSolid::MolarSolid(const MolarShape& shape) : shape_(shape), mesh_(MolarMesh(shape), DentineAndPulp()) {}

double MolarSolid::EnamelThickness(double z_m) const {
  // fraction of the crown's height from which on the enamel has its full thickness
  constexpr double kFullAt = 0.6;
  const double full_m = kFullAt * kCrown_mm * shape_.length_m / kLength_mm;
  const double u = std::clamp(z_m / full_m, 0.0, 1.0);
  return shape_.enamel_m * u * (2.0 - u);
}

MaterialIndex MolarSolid::MaterialAt(const Vector3& p_m) const {
  if (const MaterialIndex inner = mesh_.MaterialAt(p_m); inner == kPulp) return inner;
  const SurfacePoint nearest = mesh_.NearestSurface(p_m);
  return -nearest.distance_m < EnamelThickness(nearest.p_m.z()) ? kEnamel : kDentine;
}

}  // namespace osteon::simulation
