#include "simulation/packing_builder.h"

#include <algorithm>
#include <cmath>

#include "simulation/check_range.h"
#include "simulation/cover_index.h"
#include "simulation/morton.h"

namespace osteon::simulation {
namespace {

/// Side of the index's cells: 2 mm, more where the solid is so large that their number would count.
double IndexCell_m(const Eigen::AlignedBox3d& box) {
  return std::max(2.0e-3, box.sizes().maxCoeff() / 150.0);
}

constexpr std::uint64_t kSampleSalt = 1;

class Builder {
 public:
  Builder(const Solid& solid, const CutZone& zone, const PackingParams& params)
      : solid_(solid),
        zone_(zone),
        params_(params),
        index_(solid.Bounds(), IndexCell_m(solid.Bounds()), params.greatest_surface_gap_m) {}

  std::vector<Ball> Build() {
    AddLattice();
    AddSurface();
    const Eigen::AlignedBox3d box = solid_.Bounds();
    SortAlongMortonCurve(balls_, box, [](const Ball& ball) { return Vector3(ball.center_m); });
    return std::move(balls_);
  }

 private:
  void Add(const Vector3& center, double radius) {
    balls_.push_back({.center_m = center, .radius_m = radius});
    index_.Insert(balls_.back());
  }

  /// The cap on a ball's radius where the lattice has this spacing; depth is that of its centre.
  [[nodiscard]] double RadiusCap(double spacing_m, double depth_m) const {
    return std::max(params_.cup_radius_cap_m,
                    std::min(params_.radius_over_spacing * spacing_m, depth_m - params_.cup_depth_m));
  }

  [[nodiscard]] double SpacingAt(double depth_m) const {
    const std::vector<double>& from = params_.lattice.coarser_from_m;
    const auto level = std::upper_bound(from.begin(), from.end(), depth_m) - from.begin();
    return std::ldexp(params_.lattice.finest_m, static_cast<int>(level));
  }

  void AddLattice() {
    // Corners and centres of the cells, in halves of the finest spacing. Where levels meet, the finer one's
    // spacing counts.
    struct Site {
      std::array<std::int32_t, 3> at;
      int level;
      auto operator<=>(const Site&) const = default;
    };
    std::vector<Site> sites;
    for (const Cell& cell : DivideGraded(solid_, zone_, params_.lattice, CellsWanted::kSolid)) {
      const auto site = [&cell](int dx, int dy, int dz) {
        return Site{{(2 * cell.index[0] + dx) << cell.level, (2 * cell.index[1] + dy) << cell.level,
                     (2 * cell.index[2] + dz) << cell.level},
                    cell.level};
      };
      sites.push_back(site(1, 1, 1));
      for (int corner = 0; corner < 8; ++corner)
        sites.push_back(site(2 * (corner & 1), corner & 2, (corner >> 1) & 2));
    }
    std::sort(sites.begin(), sites.end());
    const auto same_place = [](const Site& a, const Site& b) { return a.at == b.at; };
    sites.erase(std::unique(sites.begin(), sites.end(), same_place), sites.end());

    for (const Site& site : sites) {
      const Vector3 p = 0.5 * params_.lattice.finest_m * Vector3(site.at[0], site.at[1], site.at[2]);
      const double spacing = std::ldexp(params_.lattice.finest_m, site.level);
      const double radius = std::min(-solid_.SignedDistance(p), RadiusCap(spacing, zone_.DepthAt(p)));
      // a smaller one adds less than the surface's own balls
      if (radius >= 0.25 * spacing) Add(p, radius);
    }
  }

  void AddSurface() {
    std::vector<Cell> cells = DivideGraded(solid_, zone_, params_.samples, CellsWanted::kSurface);
    // Scrambled, so that accepted balls do not line up with the division.
    std::vector<std::pair<std::uint64_t, std::size_t>> order(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      order[i] = {CellRandom(cells[i], kSampleSalt).NextBits(), i};
    std::sort(order.begin(), order.end());
    for (const auto& [bits, i] : order) AddTouchingBall(cells[i]);
  }

  /// Adds the largest ball that touches the surface from inside at a sample in the cell, unless the sample is
  /// covered.
  void AddTouchingBall(const Cell& cell) {
    CellRandom random(cell, kSampleSalt + 1);
    const Vector3 p = cell.least_corner() + cell.side_m * random.NextInUnitCube();
    const SurfacePoint foot = solid_.NearestSurface(p);
    if (std::abs(foot.distance_m) < 1e-9) return;  // too close to tell the normal
    const double depth = zone_.DepthAt(foot.p_m);
    const std::vector<double>& from = params_.lattice.coarser_from_m;
    const double below_finest = from.empty() ? 0.0 : std::max(0.0, depth - from.front());
    const double gap = std::min(params_.surface_gap_m + params_.surface_gap_growth * below_finest,
                                params_.greatest_surface_gap_m);
    if (index_.Covers(foot.p_m, gap)) return;

    const Vector3 inward = (p - foot.p_m) / -foot.distance_m;
    double radius = RadiusCap(SpacingAt(depth), depth);
    if (zone_.DepthAt(foot.p_m + radius * inward) - radius < params_.cup_depth_m)
      radius = std::min(radius, params_.cup_radius_cap_m);
    // Shrinking ball (Ma, Bae, Choi, The Visual Computer 28, 2012): through the foot and the surface point
    // nearest to the centre there is one ball tangent at the foot; it takes a few rounds until nothing lies
    // inside.
    constexpr int kMostRounds = 30;
    for (int round = 0; round < kMostRounds; ++round) {
      const Vector3 center = foot.p_m + radius * inward;
      const SurfacePoint nearest = solid_.NearestSurface(center);
      const Vector3 chord = nearest.p_m - foot.p_m;
      const double sagitta = chord.dot(inward);
      if (-nearest.distance_m >= radius * (1.0 - 1e-6) || sagitta <= 0.0) {
        radius = std::min(radius, -nearest.distance_m);
        if (radius >= params_.least_radius_m) Add(center, radius);
        return;
      }
      radius = std::min(0.999999 * radius, chord.squaredNorm() / (2.0 * sagitta));
      if (radius < params_.least_radius_m) return;
    }
  }

  const Solid& solid_;
  const CutZone& zone_;
  const PackingParams& params_;
  CoverIndex index_;
  std::vector<Ball> balls_;
};

void Check(const PackingParams& p) {
  CheckGrade("packing: lattice", p.lattice, 0.2e-3, 0.050);
  CheckGrade("packing: surface samples", p.samples, 0.05e-3, 0.010);
  CheckRangeMm("packing: cup radius cap", p.cup_radius_cap_m, 0.56 * p.lattice.finest_m, 0.050);
  CheckRangeMm("packing: least radius", p.least_radius_m, 0.01e-3, p.cup_radius_cap_m);
  CheckRangeMm("packing: surface gap", p.surface_gap_m, 0.005e-3, p.greatest_surface_gap_m);
  CheckRangeMm("packing: greatest surface gap", p.greatest_surface_gap_m, p.surface_gap_m, 0.010);
}

}  // namespace

PackingParams OverlapParamsFor(const Solid&, const CutZone&, const OverlapOptions& options) {
  PackingParams params;
  params.count = options.count;
  params.seed = options.seed;
  params.threads = options.threads;
  return params;
}

std::vector<Ball> BuildPacking(const Solid& solid, const CutZone& zone, const PackingParams& params) {
  Check(params);
  return Builder(solid, zone, params).Build();
}

}  // namespace osteon::simulation
