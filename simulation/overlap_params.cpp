#include <algorithm>
#include <cmath>

#include "simulation/check_range.h"
#include "simulation/packing_builder.h"

namespace osteon::simulation {
namespace {

struct Size {
  double area_m2{0.0}, volume_m3{0.0};
};

/// Surface and volume to about 5 %, counted in cells of a fortieth of the solid. On average as many centres
/// lie within half a cell's diagonal of a surface as this layer has room for.
Size Measure(const Solid& solid, int threads) {
  const double side = solid.Bounds().sizes().maxCoeff() / 40.0;
  Size size;
  for (const Cell& cell : DivideGraded(solid, EverywhereZone(), {.finest_m = side, .coarser_from_m = {}},
                                       CellsWanted::kSolid, threads)) {
    if (cell.signed_distance_m < 0.0) size.volume_m3 += side * side * side;
    if (std::abs(cell.signed_distance_m) <= cell.reach_m())
      size.area_m2 += side * side * side / (2.0 * cell.reach_m());
  }
  return size;
}

/// Samples for each ball wanted: the more, the better the choice. Millions lie densely anyway.
double SamplesPerBall(std::size_t count) {
  return std::clamp(2e3 / std::sqrt(static_cast<double>(count)), 2.0, 4.0);
}

/// Depths from which on the cap is twice, four times … what it is at the cut zone.
std::vector<double> DoublingDepths(double cap_m, double growth) {
  std::vector<double> from;
  for (int level = 1; level <= 4 && growth > 0.0; ++level) {
    const double depth = cap_m * (std::ldexp(1.0, level) - 1.0) / growth;
    if (depth <= 1.0) from.push_back(depth);
  }
  return from;
}

}  // namespace

PackingParams OverlapParamsFor(const Solid& solid, const CutZone&, const OverlapOptions& options) {
  const double most = 0.5 * solid.Bounds().sizes().minCoeff();  // no ball inside is larger
  PackingParams params;
  params.count = options.count;
  params.seed = options.seed;
  params.threads = options.threads;

  const double cap = options.greatest_radius_m != 0.0 ? options.greatest_radius_m : most;
  CheckRangeMm("overlapping packing: greatest radius", cap, 0.05e-3, 0.500);
  params.least_radius_m =
      options.least_radius_m != 0.0 ? options.least_radius_m : std::min(params.least_radius_m, 0.1 * cap);
  CheckRangeMm("overlapping packing: least radius", params.least_radius_m, 0.001e-3, cap);
  if (!(options.grade >= 0.0 && options.grade <= 1.0))
    throw std::invalid_argument(
        fmt::format("overlapping packing: grade: found {:g}, accepted 0 … 1", options.grade));
  params.cup_radius_cap_m = std::min(cap, most);
  params.radius_growth = options.grade;

  // Near the cut zone a wanted count may buy balls of twice the spacing; FittingLattice widens it.
  params.lattice.finest_m = params.cup_radius_cap_m / (options.count > 0 ? 2.0 : params.radius_over_spacing);
  params.lattice.coarser_from_m = DoublingDepths(params.cup_radius_cap_m, options.grade);
  params.samples.coarser_from_m = params.lattice.coarser_from_m;
  if (params.samples.coarser_from_m.size() > 2) params.samples.coarser_from_m.resize(2);
  params.surface_gap_growth = options.grade * params.surface_gap_m / params.cup_radius_cap_m;
  params.greatest_surface_gap_m = 5.0 * params.surface_gap_m;

  const Size size = Measure(solid, options.threads);
  if (options.count > 0) {
    params.samples.finest_m =
        std::sqrt(size.area_m2 / (SamplesPerBall(options.count) * static_cast<double>(options.count)));
  } else {
    // balls of a typical radius r close a gap g over about sqrt(2 g r)
    const double radius = std::min(params.cup_radius_cap_m, size.volume_m3 / std::max(1e-12, size.area_m2));
    params.samples.finest_m = 0.75 * std::sqrt(2.0 * params.surface_gap_m * radius);
  }
  params.samples.finest_m = std::clamp(params.samples.finest_m, 0.001e-3, 0.010);
  return params;
}

}  // namespace osteon::simulation
