#include "tests/oracles/depth_table.h"

#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "simulation/fidelity/disjoint_balls.h"

// Accuracy of removal alone: the two scenes with the recommended packings, and the paper's packing for
// comparison.

namespace osteon::simulation {
namespace {

constexpr AccuracyParams kMeasureParams{.probe_radii_m = {}, .surface_cells = 20'000, .probe_samples = 4000};

DepthRow Row(const DepthScene& scene, const DepthMethod& method, double step_m = 0.1e-3) {
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

void ExpectNothingLeft(const DepthRow& row) {
  EXPECT_LT(row.overlap_m, 1e-12) << row.method;
  EXPECT_EQ(row.accuracy.left_volume_m3, 0.0) << row.method;
  EXPECT_EQ(row.refused, 0u) << row.method;
}

TEST(DepthTable, ASplitPackingKeepsTheBlocksBars) {
  const DepthScene scene = MakeBlockScene();
  const DepthMethod ours = RecommendedMethod(scene), paper = DisjointMethod(scene, 560, 2e-3);
  const DepthRow row = Row(scene, ours), theirs = Row(scene, paper), coarse = Row(scene, ours, 0.5e-3),
                 fine = Row(scene, ours, 0.05e-3);
  ExpectNothingLeft(row);
  ExpectNothingLeft(theirs);
  EXPECT_LE(row.live, 4000u);
  EXPECT_LE(row.accuracy.depth_error_m + 2.0 * row.accuracy.depth_error_se_m, 0.06e-3);
  EXPECT_LE(row.accuracy.probes[2].p95_m, 0.03e-3);
  EXPECT_NEAR(coarse.accuracy.depth_error_m, fine.accuracy.depth_error_m, 0.005e-3);
  // split.md: 0.749 mm measured elsewhere for the paper's rule on its own packing
  EXPECT_GT(theirs.accuracy.depth_error_m, 0.5e-3);
  EXPECT_GT(theirs.accuracy.probes[2].p95_m, 0.5e-3);
}

TEST(DepthTable, HeavyOverlapKeepsTheCupsBars) {
  const DepthScene scene = MakeCupScene();
  const DepthMethod ours = RecommendedMethod(scene), paper = DisjointMethod(scene, 6000, 1.2e-3);
  const DepthRow row = Row(scene, ours), theirs = Row(scene, paper), coarse = Row(scene, ours, 0.5e-3);
  ExpectNothingLeft(row);
  ExpectNothingLeft(theirs);
  EXPECT_LE(row.live, 25'000u);
  // issue 4: 0.035 mm; and 0.03 mm for the default method on the cup
  EXPECT_LE(row.accuracy.depth_error_m + 2.0 * row.accuracy.depth_error_se_m, 0.03e-3);
  EXPECT_LE(row.accuracy.probes[2].p95_m, 0.04e-3);
  EXPECT_NEAR(coarse.accuracy.depth_error_m, row.accuracy.depth_error_m, 0.005e-3);
  EXPECT_GT(theirs.accuracy.depth_error_m, 4.0 * row.accuracy.depth_error_m);
  // the prediction that a plan compares its own packing with: rather too few balls
  const double shell_m3 = 2.0 / 3.0 * std::numbers::pi * (std::pow(33e-3, 3) - std::pow(25e-3, 3)),
               predicted = PredictDisjointBalls(theirs.accuracy.depth_error_m, shell_m3);
  EXPECT_LT(predicted, static_cast<double>(theirs.balls));
  EXPECT_GT(predicted, 0.4 * static_cast<double>(theirs.balls));
}

// cutting.md: with a capped radius the extra depth of disjoint balls is 0.385 r in theory (solid fraction
// 0.77). Without overlap, splitting gains nothing.
TEST(DepthTable, SplittingIsWhatMakesTheDifference) {
  const DepthScene scene = MakeBlockScene();
  DepthMethod plain = RecommendedMethod(scene);
  plain.split.on = false;
  plain.name = "graded, not split";
  EXPECT_GT(Row(scene, plain).accuracy.depth_error_m, 0.2e-3);
}

}  // namespace
}  // namespace osteon::simulation
