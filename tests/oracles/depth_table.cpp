#include "tests/oracles/depth_table.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "simulation/packing/disjoint_packing.h"
#include "simulation/packing/packing_builder.h"
#include "simulation/packing/split_packing.h"
#include "simulation/removal/ball_removal.h"
#include "simulation/solids/box_solid.h"
#include "simulation/solids/shell_solid.h"

namespace osteon::simulation {
namespace {

Tool OneBall(const char* name, double radius_m) {
  Tool tool;
  tool.name = name;
  tool.balls = {{.center_m = Vector3(0, 0, -radius_m), .radius_m = radius_m, .cutting = true}};
  return tool;
}

}  // namespace

std::vector<Pose> DepthScene::Path(double step_m) const {
  const Vector3 center_T = tool.balls.front().center_m;
  std::vector<Pose> path;
  const auto add = [&](const Vector3& center) {
    Pose X = Pose::Identity();
    X.linear() = Vector3(1, -1, -1).asDiagonal();
    X.translation() = center - X.linear() * center_T;
    path.push_back(X);
  };
  add(corners_m.front());
  for (std::size_t i = 0; i + 1 < corners_m.size(); ++i) {
    const Vector3 way = corners_m[i + 1] - corners_m[i];
    const int steps = std::max(1, static_cast<int>(std::ceil(way.norm() / step_m - 1e-9)));
    for (int k = 1; k <= steps; ++k) add(corners_m[i] + (static_cast<double>(k) / steps) * way);
  }
  return path;
}

DepthScene MakeBlockScene() {
  DepthScene scene;
  scene.name = "block";
  scene.solid = std::make_unique<BoxSolid>(Vector3(-10e-3, -10e-3, -20e-3), Vector3(10e-3, 10e-3, 0.0));
  scene.zone = std::make_unique<PathZone>(std::vector<Vector3>{Vector3::Zero()}, 9e-3);  // around the entry
  scene.tool = OneBall("ball of 5 mm", 5e-3);
  scene.corners_m = {{-3e-3, 0, 5.5e-3}, {-3e-3, 0, 0}, {3e-3, 0, 0}};
  return scene;
}

DepthScene MakeCupScene() {
  DepthScene scene;
  scene.name = "cup";
  scene.solid = std::make_unique<ShellSolid>(25e-3, 33e-3);
  scene.zone = std::make_unique<CupZone>(
      CutSite{.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 1), .radius_m = 25e-3});
  scene.tool = OneBall("ball of 25 mm", 25e-3);
  scene.corners_m = {{0, 0, 0}, {0, 0, -3e-3}};
  return scene;
}

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
  constexpr double kTouching_m = 1e-8;  // a ball this near the swept volume touches it
  for (const Ball& ball : live)
    if (std::abs(swept.SignedDistance(ball.center_m) - ball.radius_m) < kTouching_m) ++row.touching;
  AccuracyParams params = asked;
  const double radius_m = CuttingHead(scene.tool)->radius_m;
  params.probe_radii_m = {radius_m, 0.5 * radius_m, 1e-3};
  row.accuracy = MeasureCut(*scene.solid, BallUnion(method.balls), BallUnion(live), swept, params);
  return row;
}

DepthMethod RecommendedMethod(const DepthScene& scene) {
  constexpr double kReamer_m = 10e-3;  // larger heads cut nearly flat at the scale of the bone's balls
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
