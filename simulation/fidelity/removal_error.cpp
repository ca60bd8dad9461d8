#include "simulation/fidelity/removal_error.h"

#include <algorithm>
#include <cmath>

namespace osteon::simulation {
namespace {

// The factor k in the header's formulas: for the removal error of cuts along the surface, of cuts into the
// bone and of split balls, and for the leak. All are fitted to carved packings
// (tests/simulation/fidelity/removal_error_test.cpp). The theory for random points gives 1/(2 π) = 0.159.
constexpr double kAlong = 0.18, kInto = 0.13, kSplit = 0.08, kLeak = 0.16;
constexpr double kRimAlong = 0.08, kRimInto = 0.14;  // cross-section of a rim's lost sliver, over r²
constexpr double kMinOfCap = 0.9;  // depth at which the lattice begins, divided by r; above there are only
                                   // balls that touch the surface
constexpr double kChildRadius = 0.36;  // radius of a child over the spacing: 0.4 times its parent's 0.9

/// Number of balls per volume [1/m³] in a body-centred lattice. If balls are split, their children are
/// counted instead.
double CentersPerVolume(const PackingFineness& fine) {
  const double a = fine.spacing_m;
  return 2.0 / (a * a * a) * std::max(1, fine.children);
}

/// Number of balls per area [1/m²] that touch the surface from inside, so that the gaps between them are at
/// most surface_gap_m.
double SurfaceDensity(const PackingFineness& fine) { return 0.25 / (fine.surface_gap_m * fine.radius_m); }

/// Points at which balls touch the face of a cut.
struct Points {
  double density_1_per_m2, radius_m;  ///< radius_m: mean radius of the balls after the cut
};

/// Points that a cut leaves on its face: every ball within reach of the face is cut back until it touches it.
Points LeftPoints(const PackingFineness& fine, const CutShape& cut) {
  const double n = CentersPerVolume(fine),
               r = fine.children > 0 ? kChildRadius * fine.spacing_m : fine.radius_m;
  if (!cut.along_surface || fine.children > 0) return {.density_1_per_m2 = 2.0 * r * n, .radius_m = 0.5 * r};
  // Lattice balls: their centres lie between `from`, where the lattice begins or the tool begins to reach it,
  // and the depth h + r. Surface balls: all centres lie at the depth r.
  const double h = cut.depth_m, from = std::max(kMinOfCap * r, h - r), layer = std::max(0.0, h + r - from);
  const double lattice = n * layer, lattice_r = r - 0.25 * layer;
  const double surface = h < 2.0 * r ? SurfaceDensity(fine) : 0.0, surface_r = r - 0.5 * h;
  const double s = lattice + surface;
  return {.density_1_per_m2 = s, .radius_m = (lattice * lattice_r + surface * surface_r) / s};
}

}  // namespace

RemovalError PredictRemovalError(const PackingFineness& fine, const CutShape& cut) {
  const Points points = LeftPoints(fine, cut);
  const double k = fine.children > 0 ? kSplit : cut.along_surface ? kAlong : kInto;
  RemovalError error;
  error.face_m = k / points.density_1_per_m2 * (1.0 / points.radius_m + 1.0 / cut.tool_radius_m);
  const double r = fine.children > 0 ? kChildRadius * fine.spacing_m : fine.radius_m;
  error.rim_m = (cut.along_surface ? kRimAlong : kRimInto) * r * r * cut.rim_per_area_1_per_m;
  return error;
}

double TangentDensity(const PackingFineness& fine, const CutShape& cut) {
  return LeftPoints(fine, cut).density_1_per_m2;
}

double PredictLeak(const PackingFineness& fine, const CutShape& cut, double probe_radius_m) {
  const Points points = LeftPoints(fine, cut);
  return kLeak / points.density_1_per_m2 / (probe_radius_m + points.radius_m);
}

double PredictCogging(const PackingFineness& fine, double tool_radius_m) {
  const double apart_m = 1.0 / std::sqrt(SurfaceDensity(fine));
  return apart_m / (std::sqrt(12.0) * (tool_radius_m + fine.radius_m));
}

}  // namespace osteon::simulation
