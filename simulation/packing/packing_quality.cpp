#include "simulation/packing/packing_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "base/parallel.h"
#include "simulation/packing/ball_forest.h"
#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {
namespace {

// different salts give independent random numbers
constexpr std::uint64_t kVolumeSalt = 21, kSurfaceSalt = 22;

void Check(std::span<const Ball> balls, const QualityParams& params) {
  const auto check = [](const char* name, std::size_t value, std::size_t max_value) {
    if (value < 1000 || value > max_value)
      throw std::invalid_argument(
          fmt::format("packing quality: {}: found {}, accepted 1000 … {}", name, value, max_value));
  };
  check("samples", params.samples, 100'000'000);
  check("surface samples", params.surface_samples, 10'000'000);
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const Vector3 c = balls[i].center_m;
    const double r = balls[i].radius_m;
    if (!(r > 0.0 && r < 10.0) || !c.allFinite() || !(c.cwiseAbs().maxCoeff() < 100.0))
      throw std::invalid_argument(
          fmt::format("packing quality: ball {}: found radius {:g} m at ({:g}, {:g}, {:g}) m, accepted a "
                      "radius above 0 and below 10 m, within ±100 m",
                      i, r, c.x(), c.y(), c.z()));
  }
}

struct Samples {
  std::vector<Vector3> points_m;
  double side_m{0.0};  ///< side of the cells, each of which gave at most one sample
};

/// Takes a jittered sample of each cell of a cubic grid. `keep(cell, sample)` converts a sample to the wanted
/// point, or rejects it.
template <typename Keep>
Samples SampleCells(const Solid& solid, CellChoice wanted, double side_m, std::uint64_t salt, int threads,
                    const Keep& keep) {
  const std::vector<Cell> cells =
      DivideGraded(solid, EverywhereZone(), {.finest_m = side_m, .coarser_from_m = {}}, wanted);
  std::vector<Vector3> found(cells.size());
  std::vector<char> kept(cells.size());
  ParallelFor(cells.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      CellRandom random(cells[i], salt);
      found[i] = cells[i].min_corner() + side_m * random.NextInUnitCube();
      kept[i] = keep(cells[i], found[i]) ? 1 : 0;
    }
  });
  Samples samples{.points_m = {}, .side_m = side_m};
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (kept[i]) samples.points_m.push_back(found[i]);
  return samples;
}

/// Takes about `count` samples. A coarse grid measures the volume (dimensions 3) or area (2); from it follows
/// the spacing of a finer grid, which gives the samples.
template <typename Keep>
Samples SampleAbout(const Solid& solid, CellChoice wanted, int dimensions, std::size_t count,
                    std::uint64_t salt, int threads, const Keep& keep) {
  constexpr std::size_t kTrial = 2000;  // this number of samples measures the size to a few per cent
  double side = solid.Bounds().sizes().maxCoeff() / 16.0;
  for (;;) {
    Samples samples = SampleCells(solid, wanted, side, salt, threads, keep);
    const std::size_t n = samples.points_m.size();
    if (2 * n > count) return samples;
    // few samples do not measure the size, since a thin solid may lie between them: halve the side then
    const double finer =
        n < kTrial ? 0.5 : std::pow(static_cast<double>(n) / static_cast<double>(count), 1.0 / dimensions);
    side *= std::min(finer, 0.8);
  }
}

Samples SampleVolume(const Solid& solid, const QualityParams& params) {
  return SampleAbout(solid, CellChoice::kSolid, 3, params.samples, kVolumeSalt + (params.seed << 8),
                     params.threads, [&solid](const Cell& cell, const Vector3& p) {
                       // no query for a cell that lies entirely inside, as most cells do
                       return cell.signed_distance_m < -cell.reach_m() || solid.SignedDistance(p) < 0.0;
                     });
}

Samples SampleSurface(const Solid& solid, const QualityParams& params) {
  return SampleAbout(solid, CellChoice::kSurface, 2, params.surface_samples,
                     kSurfaceSalt + (params.seed << 8), params.threads,
                     [&solid](const Cell& cell, Vector3& p) {
                       const SurfacePoint foot = solid.NearestSurface(p);
                       p = foot.p_m;
                       return std::abs(foot.distance_m) < 0.5 * cell.side_m;
                     });
}

/// Counts balls by radius, in bins of an eighth of an octave.
/// @param min_m, max_m  smallest and largest radius
std::vector<RadiusBin> Histogram(std::span<const Ball> balls, double min_m, double max_m) {
  constexpr int kBinsPerOctave = 8;
  const auto bin = [](double radius) {
    return static_cast<int>(std::floor(kBinsPerOctave * std::log2(radius)));
  };
  const int first = bin(min_m);
  std::vector<RadiusBin> bins(bin(max_m) - first + 1);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].from_m = std::exp2(static_cast<double>(first + static_cast<int>(i)) / kBinsPerOctave);
    bins[i].to_m = std::exp2(static_cast<double>(first + static_cast<int>(i) + 1) / kBinsPerOctave);
  }
  for (const Ball& ball : balls) ++bins[bin(ball.radius_m) - first].spheres;
  return bins;
}

/// Distance from each point to the union of the balls.
std::vector<double> Gaps(const BallForest& forest, const std::vector<Vector3>& points_m, int threads) {
  std::vector<double> gaps(points_m.size());
  ParallelFor(points_m.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) gaps[i] = forest.Gap(points_m[i]);
  });
  return gaps;
}

}  // namespace

PackingQuality MeasurePacking(const Solid& solid, std::span<const Ball> balls, const QualityParams& params) {
  Check(balls, params);
  const BallForest forest(balls);
  PackingQuality quality;
  quality.spheres = balls.size();

  const Samples inside = SampleVolume(solid, params);
  const std::vector<double> volume_gaps = Gaps(forest, inside.points_m, params.threads);
  const double inside_count = static_cast<double>(inside.points_m.size());
  quality.volume_samples = inside.points_m.size();
  quality.solid_volume_m3 = inside_count * inside.side_m * inside.side_m * inside.side_m;
  quality.coverage =
      static_cast<double>(std::count(volume_gaps.begin(), volume_gaps.end(), 0.0)) / inside_count;
  quality.coverage_standard_error = std::sqrt(quality.coverage * (1.0 - quality.coverage) / inside_count);

  const Samples feet = SampleSurface(solid, params);
  std::vector<double> gaps = Gaps(forest, feet.points_m, params.threads);
  std::sort(gaps.begin(), gaps.end());
  const double foot_count = static_cast<double>(gaps.size());
  quality.surface_samples = gaps.size();
  quality.surface_area_m2 = foot_count * feet.side_m * feet.side_m;
  double sum = 0.0;
  for (const double gap : gaps) sum += gap;
  quality.surface_gap_mean_m = sum / foot_count;
  quality.surface_gap_p95_m = gaps[gaps.size() * 95 / 100];
  quality.surface_gap_max_m = gaps.back();
  for (std::size_t i = 0; i <= 100; ++i)
    quality.surface_gap_percentiles_m[i] = gaps[std::min(gaps.size() * i / 100, gaps.size() - 1)];

  if (balls.empty()) return quality;
  const auto [smallest, largest] = std::minmax_element(
      balls.begin(), balls.end(), [](const Ball& a, const Ball& b) { return a.radius_m < b.radius_m; });
  quality.r_min_m = smallest->radius_m;
  quality.r_max_m = largest->radius_m;
  quality.radius_histogram = Histogram(balls, quality.r_min_m, quality.r_max_m);
  quality.protrusion_max_m = forest.MaxProtrusion(solid, params.threads);
  quality.overlap_max_m = forest.MaxOverlap(params.threads);
  return quality;
}

}  // namespace osteon::simulation
