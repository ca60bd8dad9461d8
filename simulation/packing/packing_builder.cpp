#include "simulation/packing/packing_builder.h"

#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "simulation/packing/graded_descent.h"
#include "simulation/packing/morton.h"
#include "simulation/packing/surface_gaps.h"
#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {
namespace {

/// Largest share of the wanted number of balls that the lattice may have. The second value applies if a
/// smaller share would leave holes in the lattice.
constexpr double kLatticeShare = 0.4, kLatticeShareWithHoles = 0.75;
/// Smallest number of surface samples per wanted surface ball; fewer samples leave too little choice.
constexpr double kMinSamplesPerBall = 1.5;

void Check(const PackingParams& p) {
  CheckGrade("packing: lattice", p.lattice, 0.02e-3, 0.500);
  CheckGrade("packing: surface samples", p.samples, 0.001e-3, 0.010);
  CheckRangeMm("packing: cup radius cap", p.cup_radius_cap_m, 0.56 * p.lattice.finest_m, 0.500);
  CheckRangeMm("packing: least radius", p.min_radius_m, 0.001e-3, p.cup_radius_cap_m);
  CheckRangeMm("packing: surface gap", p.surface_gap_m, 0.001e-3, p.max_surface_gap_m);
  CheckRangeMm("packing: greatest surface gap", p.max_surface_gap_m, p.surface_gap_m, 0.050);
  if (p.radius_growth && !(*p.radius_growth >= 0.0 && *p.radius_growth <= 1.0))
    throw std::invalid_argument(
        fmt::format("packing: radius growth: found {:g}, accepted 0 … 1", *p.radius_growth));
  if (p.count > kMaxBalls)
    throw std::invalid_argument(fmt::format("packing: count: found {}, accepted 0 … {}", p.count, kMaxBalls));
}

/// Makes a body-centred lattice: each cell gives two sites, its centre and its lowest corner. A site gets a
/// ball if a radius of at least 0.9 times the cap fits there. Nearer to the surface, balls that touch the
/// surface fill the space with fewer balls.
std::vector<Ball> LatticeBalls(const Solid& solid, const CutZone& zone, const PackingParams& params) {
  const auto add = [&](const Cell& cell, std::vector<Ball>& balls) {
    const auto site = [&](const Vector3& p, double distance_m) {
      constexpr double kMinOfCap = 0.9;
      const double cap = params.RadiusCapAt(zone.DepthAt(p), cell.side_m);
      if (-distance_m >= kMinOfCap * cap)
        balls.push_back({.center_m = p, .radius_m = std::min(-distance_m, cap)});
    };
    const double distance = solid.SignedDistance(cell.center());
    if (distance > cell.reach_m()) return;
    site(cell.center(), distance);
    site(cell.min_corner(), solid.SignedDistance(cell.min_corner()));
  };
  return DescendGraded<Ball>(solid, zone, params.lattice, CellChoice::kSolid, params.threads, kMaxBalls, add);
}

/// Makes the lattice. If a number of balls is wanted, the spacing is widened until enough of them are left
/// for the surface.
std::vector<Ball> FittingLattice(const Solid& solid, const CutZone& zone, PackingParams& params) {
  const auto count = static_cast<double>(params.count);
  for (;;) {
    std::vector<Ball> balls = LatticeBalls(solid, zone, params);
    const auto found = static_cast<double>(balls.size());
    // at_holes: the spacing is near the limit of 0.56 (radius over spacing), below which the lattice has
    // holes
    const bool at_holes = params.cup_radius_cap_m < 0.6 * params.lattice.finest_m;
    const double share = at_holes ? kLatticeShareWithHoles : kLatticeShare;
    if (params.count == 0 || found <= share * count) return balls;
    // factor on the spacing that brings the number just below the share
    double widening = std::max(1.02, std::cbrt(found / (0.97 * share * count)));
    // do not widen past the spacing at which holes begin: from there on the larger share applies
    if (!at_holes)
      widening =
          std::min(widening, std::max(1.02, params.cup_radius_cap_m / (0.599 * params.lattice.finest_m)));
    params.lattice.finest_m *= widening;
  }
}

/// Finds tangent balls to choose from, sorted along a Morton curve. If they are too few for `wanted` balls,
/// the surface is sampled again more finely.
std::vector<TangentBall> EnoughTangentBalls(const Solid& solid, const CutZone& zone,
                                            const PackingParams& params, std::size_t wanted) {
  GradeParams samples = params.samples;
  constexpr int kMaxRounds = 6;
  for (int round = 0;; ++round) {
    std::vector<TangentBall> balls = FindTangentBalls(solid, zone, params, samples);
    const double samples_per_ball =
        static_cast<double>(balls.size()) / static_cast<double>(std::max<std::size_t>(1, wanted));
    if (wanted == 0 || samples_per_ball >= kMinSamplesPerBall || round == kMaxRounds) {
      SortAlongMortonCurve(balls, solid.Bounds(), [](const TangentBall& ball) { return ball.foot_m; });
      return balls;
    }
    samples.finest_m *= std::clamp(std::sqrt(samples_per_ball / (1.3 * kMinSamplesPerBall)), 0.2, 0.9);
  }
}

}  // namespace

double PackingParams::SpacingAt(double depth_m) const {
  const std::vector<double>& from = lattice.coarser_from_m;
  const auto level = std::upper_bound(from.begin(), from.end(), depth_m) - from.begin();
  return std::ldexp(lattice.finest_m, static_cast<int>(level));
}

double PackingParams::RadiusCapAt(double depth_m, double spacing_m) const {
  if (radius_growth) return cup_radius_cap_m + *radius_growth * std::max(0.0, depth_m);
  return std::max(cup_radius_cap_m, std::min(radius_over_spacing * spacing_m, depth_m - cup_depth_m));
}

double PackingParams::SurfaceGapAt(double depth_m) const {
  const std::vector<double>& from = lattice.coarser_from_m;
  const double below_finest = from.empty() ? 0.0 : std::max(0.0, depth_m - from.front());
  return std::min(surface_gap_m + surface_gap_growth * below_finest, max_surface_gap_m);
}

std::vector<Ball> BuildPacking(const Solid& solid, const CutZone& zone, const PackingParams& asked) {
  Check(asked);
  PackingParams params = asked;
  std::vector<Ball> balls = FittingLattice(solid, zone, params);
  const std::size_t wanted = params.count - std::min(params.count, balls.size());
  const std::vector<TangentBall> samples = EnoughTangentBalls(solid, zone, params, wanted);
  const std::vector<Ball> cover = CoverSurface(samples, wanted);
  balls.insert(balls.end(), cover.begin(), cover.end());
  SortAlongMortonCurve(balls, solid.Bounds(), [](const Ball& ball) { return Vector3(ball.center_m); });
  return balls;
}

}  // namespace osteon::simulation
