#include "studies/failures/cutting/leak.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/percentile.h"
#include "base/scramble.h"
#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/solids/box_solid.h"
#include "studies/failures/contact_bench.h"
#include "studies/failures/scenario_bench.h"

namespace osteon::studies {
namespace {

constexpr double kProbe_m = 0.1e-3, kPush_m = 4e-3;  // radius of the probe; depth to which the hand pushes

// Returns the largest depth of the probe's apex below the face [m] while the hand pushes it down near (x, y)
// and moves it sideways by 0.3 mm.
double DepthAt(simulation::CuttingEngine& engine, double x, double y) {
  simulation::ContactModel model;
  double deepest_m = 0.0;
  constexpr int kFrames = 120;
  for (int i = 0; i <= kFrames; ++i) {
    const double share = static_cast<double>(i) / kFrames;
    // move sideways in a pattern, to find a gap between the balls
    const Vector3 p(x + 0.3e-3 * std::sin(40.0 * share), y + 0.3e-3 * std::cos(31.0 * share) - 0.3e-3,
                    0.3e-3 - (kPush_m + 0.3e-3) * std::min(1.0, 1.5 * share));
    model = engine.Step(FrameAt(Downwards(p)));
    deepest_m = std::max(deepest_m, -Vector3(model.X_WP.p).z());
  }
  return deepest_m;
}

}  // namespace

FailureResult RunLeak(const FailureSetting& setting) {
  FailureResult result{.id = 8,
                       .name = "leak",
                       .metric = "deepest that a probe of R = 0.1 mm gets",
                       .unit = "mm",
                       .baseline_name = "inner packing of disjoint balls"};
  const double side_m = setting.full() ? 12e-3 : 8e-3;
  const simulation::BoxSolid block(Vector3(-0.5 * side_m, -0.5 * side_m, -6e-3),
                                   Vector3(0.5 * side_m, 0.5 * side_m, 0));
  const simulation::EverywhereZone zone;
  simulation::Bone whole =
      WithFriction(MakeBlock({.low_m = Vector3(-1e-3, -1e-3, -2e-3), .high_m = Vector3(1e-3, 1e-3, 0)}), 0.0);
  whole.balls = simulation::BuildPacking(block, zone, {});
  whole.points.clear();
  simulation::Bone inner = whole;
  inner.balls = simulation::BuildDisjointPacking(block, zone, {.count = whole.balls.size() / 4});
  std::vector<double> radii;
  for (const simulation::Ball& ball : inner.balls) radii.push_back(ball.radius_m);
  result.bound = 1e3 * base::Median(radii);

  const simulation::Tool probe = MakeBallTool(kProbe_m);
  const auto engine = setting.make_engine(whole, probe, Pose::Identity(), {});
  const auto leaking = setting.make_engine(inner, probe, Pose::Identity(), {});
  const simulation::CarvedState fresh = engine->Snapshot(), fresh_inner = leaking->Snapshot();
  FailureSeries of_ours{.name = "ours", .ours = true}, of_baseline{.name = "inner packing"};
  const int places = setting.full() ? 200 : 12;
  bool complete = true;
  for (int k = 0; k < places && complete; ++k) {
    const std::uint64_t bits = simulation::Scramble(0x1eafULL + static_cast<std::uint64_t>(k));
    const double x = (simulation::Uniform(bits) - 0.5) * 0.6 * side_m;
    const double y = (simulation::Uniform(simulation::Scramble(bits)) - 0.5) * 0.6 * side_m;
    engine->Restore(fresh);
    leaking->Restore(fresh_inner);
    of_ours.x.push_back(k);
    of_ours.y.push_back(1e3 * DepthAt(*engine, x, y));
    of_baseline.x.push_back(k);
    of_baseline.y.push_back(1e3 * DepthAt(*leaking, x, y));
    complete = setting.GoesOn(static_cast<double>(k + 1) / places);
  }
  result.ours = Largest(of_ours.y);
  result.baseline = Largest(of_baseline.y);
  result.baseline_fails = result.baseline > result.bound;
  result.ours_passes = complete && result.ours < result.bound;
  result.note = fmt::format("{} places; {} balls, the inner packing {}", places, whole.balls.size(),
                            inner.balls.size());
  result.plot = {
      .x_label = "place", .y_label = "depth [mm]", .series = {of_baseline, of_ours}, .bound_is_on_y = true};
  return result;
}

}  // namespace osteon::studies
