#include "simulation/metrics/depth_table.h"

#include <cmath>

#include <fmt/format.h>

#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/packing/split_packing.h"
#include "simulation/removal/ball_removal.h"

namespace osteon::simulation {

std::vector<Ball> CarveAlong(const DepthScene& scene, const std::vector<Pose>& path,
                             const DepthMethod& method, DepthRow& row) {
  std::vector<BallState> states;
  for (const Ball& ball : method.balls)
    states.push_back({.center_m = ball.center_m, .radius_m = ball.radius_m});
  BallRemoval removal(states, method.split);
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    std::vector<Capsule> capsules;
    for (const ToolBall& ball : scene.tool.balls)
      if (ball.cutting)
        capsules.push_back({.a = path[i] * Vector3(ball.center_m),
                            .b = path[i + 1] * Vector3(ball.center_m),
                            .radius_m = ball.radius_m});
    removal.Remove(capsules, states);
  }
  row.blocks = removal.max_blocks_in_use();
  row.refused = removal.refused();
  std::vector<Ball> live;
  for (const BallState& state : states)
    if (state.radius_m > 0.0) live.push_back({.center_m = state.center_m, .radius_m = state.radius_m});
  return live;
}

DepthRow MeasureDepth(const DepthScene& scene, const DepthMethod& method, double step_m,
                      const AccuracyParams& asked) {
  DepthRow row{.scene = scene.name, .method = method.name, .balls = method.balls.size()};
  const std::vector<Pose> path = scene.Path(step_m);
  const std::vector<Ball> live = CarveAlong(scene, path, method, row);
  const SweptTool swept(scene.tool, path);
  row.live = live.size();
  row.overlap_m = MaxOverlap(live, swept);
  constexpr double kTouching_m = 1e-8;
  for (const Ball& ball : live)
    if (std::abs(swept.SignedDistance(ball.center_m) - ball.radius_m) < kTouching_m) ++row.touching;
  AccuracyParams params = asked;
  const double radius_m = CuttingHead(scene.tool)->radius_m;
  params.probe_radii_m = {radius_m, 0.5 * radius_m, 1e-3};
  row.accuracy = MeasureCut(*scene.solid, BallUnion(method.balls), BallUnion(live), swept, params);
  return row;
}

DepthMethod RecommendedMethod(const DepthScene& scene) {
  constexpr double kReamer_m = 10e-3;  // to balls of a millimetre or two, the cut of such a tool is flat
  if (CuttingHead(scene.tool)->radius_m >= kReamer_m)
    return {.name = "overlap", .balls = BuildPacking(*scene.solid, *scene.zone, {}), .split = {}};
  return {.name = "graded, split",
          .balls = BuildSplitPacking(*scene.solid, *scene.zone, {}),
          .split = {.on = true}};
}

DepthMethod DisjointMethod(const DepthScene& scene, std::size_t count, double max_radius_m) {
  return {.name = fmt::format("disjoint, r <= {:g} mm", max_radius_m * 1e3),
          .balls = BuildDisjointPacking(*scene.solid, EverywhereZone(),
                                        {.count = count, .max_radius_m = max_radius_m}),
          .split = {}};
}

}  // namespace osteon::simulation
