#include "simulation/fidelity/packing_level.h"

#include <algorithm>
#include <cmath>

#include "simulation/packing/graded_cells.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/packing/split_packing.h"

namespace osteon::simulation {
namespace {

// Constants of uniform and graded levels. Divided by the lattice's spacing: smallest and largest radius of a
// ball (kMaxInto: the largest one for cuts that lead into the bone), gap at the surface, and largest gap.
// kGapGrowth is the growth of the gap per depth [m/m].
constexpr double kMinOverSpacing = 1.2, kMaxOverSpacing = 2.4, kMaxInto = 1.5;
constexpr double kGap = 0.04 / 1.5, kGapGrowth = 0.08, kMaxGap = 0.5 / 1.5;
// Constants of split levels, all divided by the lattice's spacing: radius of a lattice ball, radius of a ball
// at the surface, gap at the surface, depth between two doublings of the spacing, and smallest radius of a
// ball that is split.
constexpr double kSplitRadius = 0.9, kSplitSurface = 1.2 / 2.5, kSplitGap = 0.06, kSplitCoarser = 1.5 / 2.5;
constexpr double kMinSplit = 0.4 / 2.5;
// Split balls leave gaps at the depth at which the spacing doubles. This depth must be greater than any that
// a touched ball reaches.
constexpr double kSplitFineDepth = 1.5;  // fine depth below the zone, divided by a ball's radius
constexpr double kCornerShare = 0.5;     // PackingLevel::corner_m divided by the spacing
constexpr int kChildren = 24;            // number of children of a split ball
constexpr double kHoles = 0.56;  // smallest radius / spacing at which a body-centred lattice has no holes
constexpr double kFinest_m = 0.02e-3, kCoarsest_m = 20e-3;  // spacings that CoarsestLevel searches
// Largest ratios for which the closed forms hold: a ball's radius to the tool's radius (kMaxOfReamer: in a
// cut along the surface), a split level's spacing to the tool's radius, and a split level's spacing to the
// cut's depth.
constexpr double kMaxOfTool = 0.6, kMaxOfReamer = 0.2, kMaxSplitOfTool = 0.75, kMaxSplitOfDepth = 0.85;

// Parameters of the packing of a uniform or graded level.
PackingParams OverlapParams(const PackingLevel& level) {
  const double a = level.fine.spacing_m, r = level.fine.radius_m, d = level.zone_depth_m;
  PackingParams params;
  const double fine_m = d + r + level.corner_m;
  params.lattice = {.finest_m = a, .coarser_from_m = {fine_m, fine_m + 2.0 * r}};
  params.cup_radius_cap_m = r;
  params.cup_depth_m = d;
  params.min_radius_m = std::max(0.001e-3, 0.1 * r);
  params.surface_gap_m = level.fine.surface_gap_m;
  params.surface_gap_growth = kGapGrowth;
  params.max_surface_gap_m = kMaxGap * a;
  params.samples = {.finest_m = a / 6.0, .coarser_from_m = {d + 0.5 * r, d + 3.0 * r}};
  if (level.kind == PackingKind::kUniform) params.lattice.coarser_from_m = params.samples.coarser_from_m = {};
  return params;
}

// Parameters of the packing of a split level.
SplitPackingParams SplitParamsOf(const PackingLevel& level) {
  const double a = level.fine.spacing_m;
  return {.spacing_m = a,
          .radius_over_spacing = kSplitRadius,
          .fine_depth_m = level.zone_depth_m + kSplitFineDepth * level.fine.radius_m,
          .coarser_from_m = kSplitCoarser * a,
          .surface_radius_m = kSplitSurface * a,
          .surface_gap_m = level.fine.surface_gap_m};
}

}  // namespace

std::string_view KindName(PackingKind kind) {
  switch (kind) {
    case PackingKind::kUniform:
      return "uniform";
    case PackingKind::kGraded:
      return "graded";
    case PackingKind::kSplit:
      return "split";
  }
  return "unknown";
}

bool FitsWall(const PackingLevel& level, const CutShape& cut) {
  return level.fine.radius_m >= kHoles * level.fine.spacing_m &&
         (cut.wall_m == 0.0 || level.fine.radius_m <= 0.5 * cut.wall_m);
}

bool IsInValidRange(const PackingLevel& level, const CutShape& cut) {
  const PackingFineness& fine = level.fine;
  if (!FitsWall(level, cut)) return false;
  if (level.kind == PackingKind::kSplit)
    return fine.spacing_m <= kMaxSplitOfTool * cut.tool_radius_m &&
           (!cut.along_surface || fine.spacing_m <= kMaxSplitOfDepth * cut.depth_m);
  return fine.radius_m <= (cut.along_surface ? kMaxOfReamer : kMaxOfTool) * cut.tool_radius_m;
}

double ZoneDepthFor(const CutShape& cut, double zone_radius_m) {
  return cut.along_surface ? cut.depth_m : std::max(0.0, cut.tool_radius_m - zone_radius_m);
}

PackingLevel MakeLevel(PackingKind kind, double spacing_m, double radius_over_spacing, const CutShape& cut,
                       double zone_depth_m) {
  PackingLevel level{.kind = kind, .fine = {.spacing_m = spacing_m}, .zone_depth_m = zone_depth_m};
  PackingFineness& fine = level.fine;
  if (kind == PackingKind::kSplit) {
    fine.radius_m = kSplitRadius * spacing_m;
    fine.surface_gap_m = kSplitGap * spacing_m;
    fine.children = kChildren;
    return level;
  }
  fine.radius_m = std::clamp(radius_over_spacing, kMinOverSpacing, kMaxOverSpacing) * spacing_m;
  if (cut.wall_m > 0.0) fine.radius_m = std::min(fine.radius_m, 0.5 * cut.wall_m);
  fine.surface_gap_m = kGap * spacing_m;
  if (!cut.along_surface) level.corner_m = kCornerShare * spacing_m;
  return level;
}

PackingLevel Scaled(const PackingLevel& level, double factor, const CutShape& cut) {
  return MakeLevel(level.kind, factor * level.fine.spacing_m, level.fine.radius_m / level.fine.spacing_m, cut,
                   level.zone_depth_m);
}

std::optional<PackingLevel> CoarsestLevel(PackingKind kind, double error_m, const CutShape& cut,
                                          double zone_depth_m) {
  std::optional<PackingLevel> best;
  const double max_ratio = cut.along_surface ? kMaxOverSpacing : kMaxInto;
  for (double ratio = kMinOverSpacing; ratio < max_ratio + 0.05; ratio += 0.1) {
    const auto level_of = [&](double spacing_m) {
      return MakeLevel(kind, spacing_m, ratio, cut, zone_depth_m);
    };
    const auto serves = [&](double spacing_m) {
      const PackingLevel level = level_of(spacing_m);
      return IsInValidRange(level, cut) && PredictRemovalError(level.fine, cut).total_m() <= error_m;
    };
    if (!serves(kFinest_m)) continue;
    // find the widest spacing that meets the error, by bisection on a logarithmic scale
    double fine = kFinest_m, coarse = kCoarsest_m;
    for (int round = 0; round < 60; ++round) {
      const double middle = std::sqrt(fine * coarse);
      (serves(middle) ? fine : coarse) = middle;
    }
    if (!best || fine > best->fine.spacing_m) best = level_of(fine);
  }
  return best;
}

std::vector<Ball> PackLevel(const PackingLevel& level, const Solid& solid, const CutZone& zone) {
  if (level.kind == PackingKind::kSplit) return BuildSplitPacking(solid, zone, SplitParamsOf(level));
  if (level.kind == PackingKind::kUniform) return BuildPacking(solid, EverywhereZone(), OverlapParams(level));
  return BuildPacking(solid, zone, OverlapParams(level));
}

double ExpectedChildren(const PackingLevel& level, const CutShape& cut) {
  if (level.kind != PackingKind::kSplit) return 0.0;
  const double a = level.fine.spacing_m;
  // Number of lattice balls with centres within one radius of the cut's face, on both sides, per area of the
  // face. A body-centred lattice has 2/a³ centres per volume.
  double touched_1_per_m2 = 2.0 * level.fine.radius_m * 2.0 / (a * a * a);
  if (cut.along_surface)  // a cut along the surface touches all surface balls, too
    touched_1_per_m2 += 0.25 / (level.fine.surface_gap_m * kSplitSurface * a);
  return level.fine.children * touched_1_per_m2 * cut.area_m2;
}

CuttingParams CuttingForLevel(const PackingLevel& level, const CutShape& cut, const CuttingParams& cutting) {
  CuttingParams params = cutting;
  params.split.on = level.kind == PackingKind::kSplit;
  if (!params.split.on) return params;
  params.split.children = level.fine.children;
  params.split.min_radius_m = kMinSplit * level.fine.spacing_m;
  const double blocks = 1.5 * ExpectedChildren(level, cut) / level.fine.children;
  params.split.pool_blocks = static_cast<std::size_t>(std::clamp(blocks, 1024.0, 1e6));
  return params;
}

DepthVolumes::DepthVolumes(const Solid& solid, const CutZone& zone) {
  const double side = solid.Bounds().sizes().maxCoeff() / 60.0, volume = side * side * side;
  for (const simulation::Cell& cell :
       DivideGraded(solid, EverywhereZone(), {.finest_m = side, .coarser_from_m = {}}, CellChoice::kSolid)) {
    const double distance = cell.signed_distance_m;
    // The layer within half a cell's diagonal of the surface holds one centre per cell's volume. The area
    // follows from the volume of the cells in this layer.
    const bool at_surface = std::abs(distance) <= cell.reach_m();
    if (distance >= 0.0 && !at_surface) continue;
    cells_.push_back({.depth_m = zone.DepthAt(cell.center()),
                      .inside_m = -distance,
                      .volume_m3 = distance < 0.0 ? volume : 0.0,
                      .area_m2 = at_surface ? volume / (2.0 * cell.reach_m()) : 0.0});
  }
}

double DepthVolumes::volume_m3() const {
  double sum = 0.0;
  for (const Cell& cell : cells_) sum += cell.volume_m3;
  return sum;
}

double DepthVolumes::ExpectedBalls(const PackingLevel& level) const {
  const PackingParams overlap = OverlapParams(level);
  const SplitPackingParams split = SplitParamsOf(level);
  double balls = 0.0;  // lattice: 2/a³ per volume; surface: 0.25/(gap r) per area (SurfaceDensity)
  for (const Cell& cell : cells_) {
    if (level.kind == PackingKind::kSplit) {
      // the spacing doubles at each of two depths; surface balls grow with the depth (split_packing.cpp)
      const double below_m = std::max(0.0, cell.depth_m - split.fine_depth_m);
      const int coarser = below_m >= 2.0 * split.coarser_from_m ? 2 : below_m >= split.coarser_from_m ? 1 : 0;
      const double a = std::ldexp(split.spacing_m, coarser);
      // the numbers below are those of split_packing.cpp
      if (cell.inside_m >= 0.6 * kSplitRadius * a) balls += cell.volume_m3 * 2.0 / (a * a * a);
      const double r = split.surface_radius_m + 0.5 * below_m,
                   gap = std::min(2e-3,
                                  split.surface_gap_m + 0.4 * std::max(0.0, below_m - split.coarser_from_m));
      balls += cell.area_m2 * 0.25 / (gap * r);
      continue;
    }
    const double depth_m = level.kind == PackingKind::kUniform ? 0.0 : cell.depth_m;
    const double a = overlap.SpacingAt(depth_m), r = overlap.RadiusCapAt(depth_m, a);
    // nearer to the surface there are no lattice balls, only balls that touch the surface
    if (cell.inside_m >= 0.9 * r) balls += cell.volume_m3 * 2.0 / (a * a * a);
    balls += cell.area_m2 * 0.25 / (overlap.SurfaceGapAt(depth_m) * r);
  }
  return balls;
}

}  // namespace osteon::simulation
