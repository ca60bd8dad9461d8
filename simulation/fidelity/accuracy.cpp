#include "simulation/fidelity/accuracy.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "base/check_range.h"
#include "base/parallel.h"
#include "simulation/packing/graded_cells.h"

namespace osteon::simulation {
namespace {

constexpr double kTouch = 1e-9;      // points outside a shape, but nearer than this [m], count as inside
constexpr double kProbeStop = 1e-7;  // a probe this near to bone [m] touches it
constexpr int kSamplesPerCell = 2;   // two, because their difference gives the standard error

/// Zone of fine cells, on both sides of the swept volume's surface.
class SweepZone final : public CutZone {
 public:
  explicit SweepZone(const SweptTool& swept) : swept_(swept) {}
  [[nodiscard]] double DepthAt(const Vector3& p_m) const override {
    return std::abs(swept_.SignedDistance(p_m));
  }

 private:
  const SweptTool& swept_;
};

/// Divides the solid into cells: of side h up to a distance of 4 h from the swept surface, of side 2 h up to
/// 8 h, and so on.
std::vector<Cell> CellsAround(const Solid& solid, const SweptTool& swept, double finest_m, int threads) {
  GradeParams grade{.finest_m = finest_m, .coarser_from_m = {}};
  for (int level = 1; level <= 3; ++level)
    grade.coarser_from_m.push_back(finest_m * std::ldexp(4.0, level - 1));
  return DivideGraded(solid, SweepZone(swept), grade, CellChoice::kSolid, threads);
}

/// Results of one cell's samples. Samples are counted in four classes: bone lost outside the sweep, solid in
/// the sweep, bone left in the sweep, and solid in a layer at the sweep's surface.
struct CellFinds {
  std::uint8_t lost{0}, swept{0}, left{0}, at_surface{0};
  double left_depth_m{0.0};
  bool has_place{false};
  Vector3 place_m{Vector3::Zero()}, into_bone{Vector3::Zero()};  // place on the exact cut, for probes
  double tool_radius_m{0.0};                                     // radius of the tool that cut this place
};

/// Takes random samples in a cell, and determines for each sample how the cut changed the bone there.
class Sampler {
 public:
  Sampler(const Solid& solid, const CarvedShape& before, const CarvedShape& after, const SweptTool& swept,
          double layer_m)
      : solid_(solid), before_(before), after_(after), swept_(swept), layer_m_(layer_m) {}

  [[nodiscard]] CellFinds SampleCell(const Cell& cell, std::uint64_t seed) const {
    CellFinds finds;
    CellRandom random(cell, seed);
    for (int i = 0; i < kSamplesPerCell; ++i) {
      const Vector3 p = cell.min_corner() + cell.side_m * random.NextInUnitCube();
      if (solid_.SignedDistance(p) >= 0.0) continue;
      const SweptDistance to_cut = swept_.Nearest(p);
      const double d = to_cut.distance_m;
      if (std::abs(d) < layer_m_) ++finds.at_surface;
      const bool left = Holds(after_, p);
      if (d <= 0.0) {
        ++finds.swept;
        if (!left || d > -kTouch) continue;
        ++finds.left;
        finds.left_depth_m = std::max(finds.left_depth_m, -d);
        continue;
      }
      if (!left && Holds(before_, p)) ++finds.lost;
      if (d < layer_m_ && !finds.has_place) {
        const Vector3 out = p - to_cut.axis_G;
        finds.into_bone = out.normalized();
        finds.place_m = p - d * finds.into_bone;
        finds.tool_radius_m = out.norm() - d;
        finds.has_place = solid_.SignedDistance(finds.place_m) < 0.0;
      }
    }
    return finds;
  }

 private:
  // Whether the point is in the shape.
  static bool Holds(const CarvedShape& shape, const Vector3& p) { return shape.Distance(p, kTouch) < kTouch; }

  const Solid& solid_;
  const CarvedShape &before_, &after_;
  const SweptTool& swept_;
  double layer_m_;
};

std::vector<CellFinds> SampleSweepCells(const std::vector<Cell>& cells, const Sampler& sampler,
                                        const AccuracyParams& params) {
  std::vector<CellFinds> finds(cells.size());
  ParallelFor(cells.size(), params.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) finds[i] = sampler.SampleCell(cells[i], params.seed);
  });
  return finds;
}

/// Distance that a probe ball moves from the exact cut into the bone until it touches bone. It is found by
/// sphere tracing: a step as long as the present clearance cannot pass through bone.
double GapAt(const CarvedShape& shape, const CellFinds& at, double radius_m, double deepest_m) {
  const Vector3 start = at.place_m - radius_m * at.into_bone;
  double gap = 0.0;
  while (gap < deepest_m) {
    const double clear =
        shape.Distance(start + gap * at.into_bone, radius_m + deepest_m - gap + kProbeStop) - radius_m;
    if (clear < kProbeStop) break;
    gap += clear;
  }
  return std::min(gap, deepest_m);
}

/// Statistics of GapAt over these places on the cut, for one probe.
ProbeGap MeasureProbeGap(const CarvedShape& shape, const std::vector<const CellFinds*>& places,
                         double radius_m, const AccuracyParams& params) {
  std::vector<double> gaps(places.size());
  ParallelFor(
      places.size(), params.threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          gaps[i] = GapAt(shape, *places[i], radius_m, params.deepest_gap_m);
      },
      16);
  ProbeGap felt{.radius_m = radius_m, .samples = gaps.size()};
  if (gaps.empty()) return felt;
  std::sort(gaps.begin(), gaps.end());
  for (const double gap : gaps) felt.mean_m += gap;
  felt.mean_m /= static_cast<double>(gaps.size());
  felt.p95_m = gaps[static_cast<std::size_t>(0.95 * static_cast<double>(gaps.size() - 1))];
  felt.max_m = gaps.back();
  return felt;
}

/// Area of the swept volume's surface within the solid: volume of the samples that are nearer than `layer_m`
/// to the surface, divided by the thickness of this layer, 2 layer_m.
double AreaOf(const std::vector<Cell>& cells, const std::vector<CellFinds>& finds, double layer_m) {
  double volume = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i)
    volume += std::pow(cells[i].side_m, 3) * finds[i].at_surface / kSamplesPerCell;
  return volume / (2.0 * layer_m);
}

}  // namespace

CutAccuracy MeasureCut(const Solid& solid, const CarvedShape& before, const CarvedShape& after,
                       const SweptTool& swept, const AccuracyParams& params) {
  for (const double radius : params.probe_radii_m)
    CheckRangeMm("accuracy: probe's radius", radius, 1e-6, 1.0);
  const Eigen::AlignedBox3d box = swept.Bounds().intersection(solid.Bounds());
  if (swept.empty() || box.isEmpty()) throw std::invalid_argument("accuracy: nothing was swept");

  // first measure the cut's area coarsely, to choose the size of the cells
  const double coarse_m = box.sizes().maxCoeff() / 40.0;
  std::vector<Cell> cells = CellsAround(solid, swept, coarse_m, params.threads);
  std::vector<CellFinds> finds =
      SampleSweepCells(cells, Sampler(solid, before, after, swept, coarse_m), params);
  const double area = std::max(AreaOf(cells, finds, coarse_m), coarse_m * coarse_m);
  // with this side, about surface_cells cells lie along the cut
  const double finest_m =
      std::sqrt(area / static_cast<double>(std::max<std::size_t>(1, params.surface_cells)));
  cells = CellsAround(solid, swept, finest_m, params.threads);
  finds = SampleSweepCells(cells, Sampler(solid, before, after, swept, finest_m), params);

  CutAccuracy result;
  result.cut_area_m2 = AreaOf(cells, finds, finest_m);
  double variance = 0.0;
  std::vector<const CellFinds*> places;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const double share = std::pow(cells[i].side_m, 3) / kSamplesPerCell;
    const CellFinds& found = finds[i];
    result.lost_m3 += share * found.lost;
    result.swept_volume_m3 += share * found.swept;
    result.left_volume_m3 += share * found.left;
    result.left_depth_m = std::max(result.left_depth_m, found.left_depth_m);
    if (found.lost == 1) variance += share * share;  // variance of share (a + b): share^2 (a - b)^2
    if (found.has_place) places.push_back(&found);
  }
  if (result.cut_area_m2 > 0.0) {
    result.depth_error_m = result.lost_m3 / result.cut_area_m2;
    result.depth_error_se_m = std::sqrt(variance) / result.cut_area_m2;
  }
  for (const double radius : params.probe_radii_m) {
    std::vector<const CellFinds*> fitting;  // places on cuts that are wide enough for the probe
    for (const CellFinds* place : places)
      if (place->tool_radius_m >= radius - kProbeStop) fitting.push_back(place);
    const std::size_t max_places = std::max<std::size_t>(1, params.probe_samples);
    const std::size_t stride = (fitting.size() + max_places - 1) / max_places;
    std::vector<const CellFinds*> chosen;
    for (std::size_t i = 0; i < fitting.size(); i += stride) chosen.push_back(fitting[i]);
    result.probes.push_back(MeasureProbeGap(after, chosen, radius, params));
  }
  return result;
}

double MaxOverlap(std::span<const Ball> balls, const SweptTool& swept) {
  double greatest = 0.0;
  for (const Ball& ball : balls)
    if (ball.radius_m > 0.0)
      greatest = std::max(greatest, ball.radius_m - swept.SignedDistance(Vector3(ball.center_m)));
  return greatest;
}

}  // namespace osteon::simulation
