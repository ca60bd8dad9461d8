#include <algorithm>
#include <cmath>

#include "base/check_range.h"
#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {
namespace {

constexpr double kLatticeShare = 0.38;  // share of the wanted number of balls that the lattice gets at first

/// Area and volume of a solid, measured coarsely. They determine the numbers of samples and balls.
struct Demand {
  double area_m2{0.0}, volume_m3{0.0};
  double sampled_area_m2{0.0};    ///< area of the surface; divided by 4 for each coarser level of the samples
  double lattice_volume_m3{0.0};  ///< volume deeper than the cap; divided by 8 for each coarser level
};

/// Returns factor^level, where `level` is the number of entries of `from_m` that are at most `depth_m`.
double CoarserBy(const std::vector<double>& from_m, double depth_m, double factor) {
  const auto level = std::upper_bound(from_m.begin(), from_m.end(), depth_m) - from_m.begin();
  return std::pow(factor, static_cast<double>(level));
}

/// Measures the demand to about 5 %, in cells of a fortieth of the solid's size. The area is the volume of
/// the cells whose centres lie within half a diagonal of the surface, divided by the thickness of this layer.
Demand Measure(const Solid& solid, const CutZone& zone, const PackingParams& params) {
  const double side = solid.Bounds().sizes().maxCoeff() / 40.0, volume = side * side * side;
  Demand demand;
  for (const Cell& cell : DivideGraded(solid, EverywhereZone(), {.finest_m = side, .coarser_from_m = {}},
                                       CellChoice::kSolid, params.threads)) {
    const double distance = cell.signed_distance_m, depth = zone.DepthAt(cell.center());
    if (std::abs(distance) <= cell.reach_m()) {
      const double area = volume / (2.0 * cell.reach_m());
      demand.area_m2 += area;
      demand.sampled_area_m2 += area * CoarserBy(params.samples.coarser_from_m, depth, 0.25);
    }
    if (distance >= 0.0) continue;
    demand.volume_m3 += volume;
    if (-distance >= 0.9 * params.RadiusCapAt(depth, params.SpacingAt(depth)))
      demand.lattice_volume_m3 += volume * CoarserBy(params.lattice.coarser_from_m, depth, 0.125);
  }
  return demand;
}

/// Number of samples for each wanted ball. More samples give a better choice; millions of balls need fewer
/// each, because they are dense in any case.
double SamplesPerBall(std::size_t count) {
  return std::clamp(2e3 / std::sqrt(static_cast<double>(count)), 2.0, 4.0);
}

/// Depths at which the cap reaches 2, 4, 8 and 16 times its value at the cut zone.
std::vector<double> DoublingDepths(double cap_m, double growth) {
  std::vector<double> from;
  for (int level = 1; level <= 4 && growth > 0.0; ++level) {
    const double depth = cap_m * (std::ldexp(1.0, level) - 1.0) / growth;
    if (depth <= 1.0) from.push_back(depth);
  }
  return from;
}

}  // namespace

PackingParams OverlapParamsFor(const Solid& solid, const CutZone& zone, const OverlapOptions& options) {
  const double max_radius = 0.5 * solid.Bounds().sizes().minCoeff();  // no ball in the solid can be larger
  PackingParams params;
  params.count = options.count;
  params.seed = options.seed;
  params.threads = options.threads;

  const double cap = options.max_radius_m != 0.0 ? options.max_radius_m : max_radius;
  CheckRangeMm("overlapping packing: greatest radius", cap, 0.05e-3, 0.500);
  params.min_radius_m =
      options.min_radius_m != 0.0 ? options.min_radius_m : std::min(params.min_radius_m, 0.1 * cap);
  CheckRangeMm("overlapping packing: least radius", params.min_radius_m, 0.001e-3, cap);
  if (!(options.grade >= 0.0 && options.grade <= 1.0))
    throw std::invalid_argument(
        fmt::format("overlapping packing: grade: found {:g}, accepted 0 … 1", options.grade));
  params.cup_radius_cap_m = std::min(cap, max_radius);
  params.radius_growth = options.grade;

  params.lattice.coarser_from_m = DoublingDepths(params.cup_radius_cap_m, options.grade);
  // Samples become coarser at fewer depths than the lattice: otherwise there would be too few samples for a
  // large count.
  params.samples.coarser_from_m = params.lattice.coarser_from_m;
  if (params.samples.coarser_from_m.size() > 2) params.samples.coarser_from_m.resize(2);
  params.surface_gap_growth = options.grade * params.surface_gap_m / params.cup_radius_cap_m;
  params.max_surface_gap_m = 5.0 * params.surface_gap_m;

  // At a spacing of half the cap, the lattice's balls overlap as heavily as a cut needs (1.5 mm for balls of
  // 3 mm).
  params.lattice.finest_m = params.cup_radius_cap_m / (options.count > 0 ? 2.0 : params.radius_over_spacing);
  const Demand demand = Measure(solid, zone, params);
  if (options.count > 0) {
    const auto count = static_cast<double>(options.count);
    const double widest = params.cup_radius_cap_m /
                          0.6;  // widest spacing just without holes; BuildPacking may widen it further
    // spacing at which the lattice has its share of the balls
    const double fitting = std::cbrt(2.0 * demand.lattice_volume_m3 / (kLatticeShare * count));
    params.lattice.finest_m = std::clamp(fitting, params.lattice.finest_m, widest);
    params.samples.finest_m = std::sqrt(demand.sampled_area_m2 / (SamplesPerBall(options.count) * count));
  } else {
    // a ball of typical radius r keeps the gap below g up to a distance of about sqrt(2 g r)
    const double radius =
        std::min(params.cup_radius_cap_m, demand.volume_m3 / std::max(1e-12, demand.area_m2));
    params.samples.finest_m = 0.75 * std::sqrt(2.0 * params.surface_gap_m * radius);
  }
  params.samples.finest_m = std::clamp(params.samples.finest_m, 0.001e-3, 0.010);
  return params;
}

}  // namespace osteon::simulation
