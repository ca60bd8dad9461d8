#include "tests/oracles/depth_table.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "simulation/fidelity/disjoint_balls.h"

// Tests of the accuracy of removal alone, without contact: two scenes, a block and a cup, with the
// recommended packings, and with the paper's packing of disjoint balls for comparison.

namespace osteon::simulation {
namespace {

constexpr AccuracyParams kMeasureParams{.probe_radii_m = {}, .surface_cells = 20'000, .probe_samples = 4000};

/// Carves the scene along its path in steps of step_m, measures the result and prints it.
DepthRow MeasureAndPrint(const DepthScene& scene, const DepthMethod& method, double step_m = 0.1e-3) {
  const DepthRow row = MeasureDepth(scene, method, step_m, kMeasureParams);
  const CutAccuracy& a = row.accuracy;
  std::printf(
      "%-5s %-22s %6zu balls, %6zu live, %6zu touch | depth error %.4f +- %.4f mm | probe R %.4f/%.4f "
      "R/2 %.4f/%.4f 1 mm %.4f/%.4f mm\n",
      row.scene.c_str(), row.method.c_str(), row.balls, row.live, row.touching, a.depth_error_m * 1e3,
      a.depth_error_se_m * 1e3, a.probes[0].mean_m * 1e3, a.probes[0].p95_m * 1e3, a.probes[1].mean_m * 1e3,
      a.probes[1].p95_m * 1e3, a.probes[2].mean_m * 1e3, a.probes[2].p95_m * 1e3);
  return row;
}

/// Expects no bone left in the tool's sweep, and no ball that should have been split but was not.
void ExpectNothingLeft(const DepthRow& row) {
  EXPECT_LT(row.overlap_m, 1e-12) << row.method;
  EXPECT_EQ(row.accuracy.left_volume_m3, 0.0) << row.method;
  EXPECT_EQ(row.refused, 0u) << row.method;
}

TEST(DepthTable, ASplitPackingMeetsTheBlocksLimits) {
  const DepthScene scene = MakeBlockScene();
  const DepthMethod ours = RecommendedMethod(scene), paper = DisjointMethod(scene, 560, 2e-3);
  const DepthRow row = MeasureAndPrint(scene, ours), theirs = MeasureAndPrint(scene, paper),
                 coarse = MeasureAndPrint(scene, ours, 0.5e-3), fine = MeasureAndPrint(scene, ours, 0.05e-3);
  ExpectNothingLeft(row);
  ExpectNothingLeft(theirs);
  EXPECT_LE(row.live, 4000u);
  EXPECT_LE(row.accuracy.depth_error_m + 2.0 * row.accuracy.depth_error_se_m, 0.06e-3);
  EXPECT_LE(row.accuracy.probes[2].p95_m, 0.03e-3);
  EXPECT_NEAR(coarse.accuracy.depth_error_m, fine.accuracy.depth_error_m, 0.005e-3);
  // the paper's rule on its own packing was measured independently: 0.749 mm
  EXPECT_GT(theirs.accuracy.depth_error_m, 0.5e-3);
  EXPECT_GT(theirs.accuracy.probes[2].p95_m, 0.5e-3);
}

TEST(DepthTable, HeavilyOverlappingBallsMeetTheCupsLimits) {
  const DepthScene scene = MakeCupScene();
  const DepthMethod ours = RecommendedMethod(scene), paper = DisjointMethod(scene, 6000, 1.2e-3);
  const DepthRow row = MeasureAndPrint(scene, ours), theirs = MeasureAndPrint(scene, paper),
                 coarse = MeasureAndPrint(scene, ours, 0.5e-3);
  ExpectNothingLeft(row);
  ExpectNothingLeft(theirs);
  EXPECT_LE(row.live, 25'000u);
  // the requirement is 0.035 mm, and 0.03 mm for the default method on the cup
  EXPECT_LE(row.accuracy.depth_error_m + 2.0 * row.accuracy.depth_error_se_m, 0.03e-3);
  EXPECT_LE(row.accuracy.probes[2].p95_m, 0.04e-3);
  EXPECT_NEAR(coarse.accuracy.depth_error_m, row.accuracy.depth_error_m, 0.005e-3);
  EXPECT_GT(theirs.accuracy.depth_error_m, 4.0 * row.accuracy.depth_error_m);
  // A plan compares its packing with this predicted number of disjoint balls. If the prediction is wrong, it
  // must be too low, so that it does not favour the plan.
  const double shell_m3 = 2.0 / 3.0 * std::numbers::pi * (std::pow(33e-3, 3) - std::pow(25e-3, 3)),
               predicted = PredictDisjointBalls(theirs.accuracy.depth_error_m, shell_m3);
  EXPECT_LT(predicted, static_cast<double>(theirs.balls));
  EXPECT_GT(predicted, 0.4 * static_cast<double>(theirs.balls));
}

// With splitting, the same packing is within 0.06 mm (test ASplitPackingMeetsTheBlocksLimits).
TEST(DepthTable, TheBlocksPackingIsInaccurateWithoutSplitting) {
  const DepthScene scene = MakeBlockScene();
  DepthMethod plain = RecommendedMethod(scene);
  plain.split.on = false;
  plain.name = "graded, not split";
  EXPECT_GT(MeasureAndPrint(scene, plain).accuracy.depth_error_m, 0.2e-3);
}

}  // namespace
}  // namespace osteon::simulation
