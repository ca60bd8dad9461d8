#include "simulation/packing/split_packing.h"

#include <algorithm>

#include "base/check_range.h"
#include "simulation/packing/graded_cells.h"
#include "simulation/packing/morton.h"
#include "simulation/packing/surface_gaps.h"
#include "simulation/packing/tangent_balls.h"

namespace osteon::simulation {
namespace {

// Smallest radius of a lattice ball near the surface, over its cap. Where only smaller ones fit, surface
// balls fill the space instead.
constexpr double kMinOfCap = 0.6;
// Growth of the surface balls' largest radius and of the gap with the depth below the zone [m/m], and the
// largest gap.
constexpr double kRadiusGrowth = 0.5, kGapGrowth = 0.4, kMaxGap_m = 2e-3;

/// A zone that is extended downwards: points less than `fine_depth_m` below the given zone belong to it.
class FineZone final : public CutZone {
 public:
  FineZone(const CutZone& zone, double fine_depth_m) : zone_(zone), fine_depth_m_(fine_depth_m) {}
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override {
    const double depth = zone_.DepthAt(p_m);
    return depth < fine_depth_m_ ? std::min(depth, 0.0) : depth - fine_depth_m_;
  }

 private:
  const CutZone& zone_;
  double fine_depth_m_;
};

/// Makes a body-centred lattice: two balls for each cell of a graded division. Balls of coarse cells do not
/// reach into the fine part.
std::vector<Ball> LatticeBalls(const Solid& solid, const CutZone& zone, const SplitPackingParams& p) {
  const GradeParams grade{.finest_m = p.spacing_m,
                          .coarser_from_m = {p.coarser_from_m, 2.0 * p.coarser_from_m}};
  const double fine_cap = p.radius_over_spacing * p.spacing_m;
  std::vector<Ball> balls;
  for (const Cell& cell : DivideGraded(solid, zone, grade, CellChoice::kSolid, p.threads))
    for (const Vector3& site : {cell.center(), cell.min_corner()}) {
      double cap = p.radius_over_spacing * cell.side_m;
      if (cell.level > 0)
        cap = std::min(cap, std::max(fine_cap, zone.DepthAt(site) - p.coarser_from_m + fine_cap));
      const double inside = -solid.SignedDistance(site);
      if (inside >= kMinOfCap * cap) balls.push_back({.center_m = site, .radius_m = std::min(cap, inside)});
    }
  return balls;
}

}  // namespace

std::vector<Ball> BuildSplitPacking(const Solid& solid, const CutZone& cut, const SplitPackingParams& p) {
  CheckRangeMm("split packing: fine depth", p.fine_depth_m, 0.0, 0.100);
  const FineZone zone(cut, p.fine_depth_m);
  CheckGrade("split packing: lattice", {.finest_m = p.spacing_m, .coarser_from_m = {p.coarser_from_m}},
             0.05e-3, 0.100);
  CheckRangeMm("split packing: lattice ball's radius", p.radius_over_spacing * p.spacing_m,
               0.56 * p.spacing_m, 2.0 * p.spacing_m);
  CheckRangeMm("split packing: surface radius", p.surface_radius_m, 0.02e-3, 0.100);
  CheckRangeMm("split packing: surface gap", p.surface_gap_m, 0.001e-3, kMaxGap_m);

  PackingParams surface;
  surface.lattice = {.finest_m = p.spacing_m, .coarser_from_m = {p.coarser_from_m}};
  surface.cup_radius_cap_m = p.surface_radius_m;
  surface.radius_growth = kRadiusGrowth;
  surface.min_radius_m = 0.1 * p.surface_radius_m;
  surface.surface_gap_m = p.surface_gap_m;
  surface.surface_gap_growth = kGapGrowth;
  surface.max_surface_gap_m = kMaxGap_m;
  surface.seed = p.seed;
  surface.threads = p.threads;
  std::vector<TangentBall> samples = FindTangentBalls(
      solid, zone, surface,
      {.finest_m = 0.25 * p.surface_radius_m, .coarser_from_m = {p.coarser_from_m, 2.0 * p.coarser_from_m}});
  SortAlongMortonCurve(samples, solid.Bounds(), [](const TangentBall& ball) { return ball.foot_m; });

  std::vector<Ball> balls = LatticeBalls(solid, zone, p);
  const std::vector<Ball> cover = CoverSurface(samples, 0);
  balls.insert(balls.end(), cover.begin(), cover.end());
  SortAlongMortonCurve(balls, solid.Bounds(), [](const Ball& ball) { return Vector3(ball.center_m); });
  return balls;
}

SplitPackingParams SplitPackingFor(const PackingParams& packing) {
  const SplitPackingParams usual;
  const double spacing_m = 5.0 / 3.0 * packing.lattice.finest_m, scale = spacing_m / usual.spacing_m;
  return {.spacing_m = spacing_m,
          .fine_depth_m = packing.cup_depth_m,
          .coarser_from_m = scale * usual.coarser_from_m,
          .surface_radius_m = scale * usual.surface_radius_m,
          .surface_gap_m = packing.surface_gap_m,
          .seed = packing.seed,
          .threads = packing.threads};
}

}  // namespace osteon::simulation
