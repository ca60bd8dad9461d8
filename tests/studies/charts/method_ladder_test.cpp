#include "studies/charts/method_ladder.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "studies/charts/chart_speed_accuracy.h"

// The steps that `chart speed-accuracy` compares: their methods, their lengths from coarse to fine, and which
// steps share a packing.

namespace osteon::studies {
namespace {

TEST(MethodLadder, GoesFromCoarseToFineWithEveryMethodAlsoWhenQuick) {
  for (const bool quick : {false, true}) {
    const std::vector<MethodStep> ladder = MethodLadder(quick);
    std::set<std::string> methods;
    for (std::size_t i = 0; i < ladder.size(); ++i) {
      methods.insert(ladder[i].method);
      if (i > 0 && ladder[i].method == ladder[i - 1].method) {
        EXPECT_LT(ladder[i].length_m, ladder[i - 1].length_m) << ladder[i].method;
      }
    }
    EXPECT_EQ(methods, std::set<std::string>(LadderMethods().begin(), LadderMethods().end()));
    EXPECT_TRUE(methods.contains("split"));
  }
}

TEST(MethodLadder, SplitUsesOurEngineWithLargeBallsAndRoomForTheirChildren) {
  const MethodStep split{.method = "split", .length_m = 5.6e-3}, ours{.method = "ours", .length_m = 1.5e-3};
  EXPECT_EQ(EngineOfStep(split), "ours");
  EXPECT_EQ(EngineOfStep(ours), "ours");
  EXPECT_EQ(EngineOfStep({.method = "voxel", .length_m = 1e-3}), "voxel");
  EXPECT_EQ(EngineOfStep({.method = "cpu-split", .length_m = 1e-3}), "cpu");
  const simulation::CutWorkload work = MakeCutWorkload(simulation::CutTask::kChannel);
  EXPECT_FALSE(CuttingForStep(ours, work).split.on);
  const simulation::CuttingParams cutting = CuttingForStep(split, work);
  EXPECT_TRUE(cutting.split.on);
  EXPECT_EQ(cutting.law, work.cutting.law);
  const LadderBone large = PackForStep(split, work, {}, 0), small = PackForStep(ours, work, {}, 0);
  EXPECT_LT(2 * large.bone.balls.size(), small.bone.balls.size());
  EXPECT_GT(large.r_max_m, 1.5 * small.r_max_m);
  // balls are split, except the smallest at the surface, which shrink
  const auto is_smaller = [](const auto& a, const auto& b) { return a.radius_m < b.radius_m; };
  const double least_m =
      std::min_element(large.bone.balls.begin(), large.bone.balls.end(), is_smaller)->radius_m;
  EXPECT_GT(cutting.split.min_radius_m, least_m);
  EXPECT_LT(cutting.split.min_radius_m, 0.25 * large.r_max_m);
  EXPECT_GT(cutting.split.pool_blocks, large.bone.balls.size());
}

TEST(MethodLadder, StepsShareAPackingExactlyIfTheirBallsAreEqual) {
  const simulation::CutWorkload work = MakeCutWorkload(simulation::CutTask::kChannel);
  const std::vector<MethodStep> steps{
      {.method = "ours", .length_m = 4e-3},  {.method = "stamps", .length_m = 4e-3},
      {.method = "paper", .length_m = 4e-3}, {.method = "paper-printed", .length_m = 4e-3},
      {.method = "split", .length_m = 4e-3}, {.method = "ours", .length_m = 5e-3},
      {.method = "cpu", .length_m = 4e-3},   {.method = "cpu-split", .length_m = 4e-3}};
  std::vector<std::vector<simulation::Ball>> packed;
  for (const MethodStep& step : steps) packed.push_back(PackForStep(step, work, {}, 1).bone.balls);
  const auto same = [&](std::size_t i, std::size_t j) {
    return std::equal(packed[i].begin(), packed[i].end(), packed[j].begin(), packed[j].end(),
                      [](const simulation::Ball& a, const simulation::Ball& b) {
                        return Vector3(a.center_m) == Vector3(b.center_m) && a.radius_m == b.radius_m;
                      });
  };
  for (std::size_t i = 0; i < steps.size(); ++i)
    for (std::size_t j = 0; j < steps.size(); ++j)
      EXPECT_EQ(SharePacking(steps[i], steps[j]), same(i, j)) << steps[i].method << " " << steps[j].method;
}

TEST(SpeedAccuracyChart, NamesEveryMethodAndStatesTheRangeOfItsSeeds) {
  SpeedAccuracyResult result{.machine = "m", .device = "d", .points = {}, .left_out = {}};
  double us = 10.0;
  for (const std::string& method : LadderMethods()) {
    SpeedAccuracyPoint point{
        .method = method, .device = "d", .length_m = 1e-3, .spheres = 1000, .r_max_m = 1e-3};
    for (const double error_mm : {0.02, 0.05, 0.03}) {
      SeedScores seed;
      seed.scores.depth_error_m = 1e-3 * error_mm;
      seed.frame_us.p50_us = us;
      point.seeds.push_back(seed);
    }
    us *= 2.0;
    const SeedRange depth = SeedRangeOf(point, ChartFigure::kDepth);
    EXPECT_NEAR(depth.median, 0.03, 1e-12);
    EXPECT_NEAR(depth.low, 0.02, 1e-12);
    EXPECT_NEAR(depth.high, 0.05, 1e-12);
    point.seeds.pop_back();  // median of an even number: the mean of the middle two
    EXPECT_NEAR(SeedRangeOf(point, ChartFigure::kDepth).median, 0.035, 1e-12);
    result.points.push_back(point);
  }
  const std::string svg = SpeedAccuracySvg(result);
  for (const char* name : {">ours on one thread<", ">ours on one thread, split<", ">ours<", ">ours, split<",
                           ">stamps at discrete poses<", ">paper, corrected<", ">paper, as printed<",
                           ">voxels, finger-proxy<", ">voxmap-pointshell<"})
    EXPECT_NE(svg.find(name), std::string::npos) << name;
}

}  // namespace
}  // namespace osteon::studies
