#include <cstdio>

#include <gtest/gtest.h>

#include "gpu/engine/vulkan_engine.h"
#include "session/planning/plan.h"

// Tests that a plan's packing is fine enough and no finer than needed, on Vulkan. The next finer level (half
// the spacing) changes the force by less than 7 % and the depth by less than the error. The next coarser
// level (twice the spacing) exceeds the error. No clock is involved.

namespace osteon::session {
namespace {

// A packing, its measured error of removal, and the forces in its run.
struct Level {
  PackedLevel packed;
  double error_m{0.0};
  std::vector<simulation::FeltForce> felt;
};

// Packs a level, runs the scene's tool path in it and measures its error.
Level Measure(const PlanScene& scene, const simulation::Tool& tool, const simulation::PackingLevel& level) {
  PackedLevel packed{.level = level, .balls = PackLevel(level, *scene.work.solid, *scene.work.zone)};
  auto runs = RunLevels(scene, {packed}, tool, {}, 1);
  if (!runs) throw std::runtime_error(runs.error());
  const auto cut = MeasureLevel(scene, packed, runs->front(), std::min(1e-3, 0.5 * scene.cut.tool_radius_m));
  const double left_m = cut.MeanLeft_m();
  std::printf("%s %s a %.3f mm: %zu balls, error %.4f mm, predicted %.4f mm\n", scene.name.c_str(),
              std::string(KindName(level.kind)).c_str(), level.fine.spacing_m * 1e3, packed.balls.size(),
              (cut.depth_error_m + left_m) * 1e3, PredictRemovalError(level.fine, scene.cut).total_m() * 1e3);
  return {.packed = std::move(packed),
          .error_m = cut.depth_error_m + left_m,
          .felt = std::move(runs->front().felt)};
}

// A scene, and the error that is accepted for it.
struct Case {
  const char* scene;
  double error_mm;
};

class PlanLevels : public testing::TestWithParam<Case> {};

TEST_P(PlanLevels, AreNeitherFinerNorCoarserThanTheyHaveToBe) {
  const Case asked = GetParam();
  const auto scene =
      LoadPlanScene({.scene = asked.scene, .cell = {}, .config_root = OSTEON_SOURCE_DIR "/config"});
  ASSERT_TRUE(scene) << scene.error();
  const double error_m = 1e-3 * asked.error_mm;
  const ModelChoice model = ChooseModel(*scene, error_m);
  ASSERT_TRUE(model.level);
  const Level own = Measure(*scene, model.tool, *model.level),
              finer = Measure(*scene, model.tool, Scaled(*model.level, 0.5, scene->cut)),
              coarser = Measure(*scene, model.tool, Scaled(*model.level, 2.0, scene->cut));
  EXPECT_LE(own.error_m, error_m);
  EXPECT_LT(std::abs(finer.error_m - own.error_m), error_m);
  const simulation::ForceErrors force = CompareForces(own.felt, finer.felt, scene->work.rate_hz);
  std::printf("  force off the finer level's by %.4f\n", force.force_relative);
  EXPECT_LT(force.force_relative, 0.07);
  EXPECT_GT(coarser.error_m, error_m) << "a coarser packing would have done";
}

INSTANTIATE_TEST_SUITE_P(Scenes, PlanLevels,
                         testing::Values(Case{"acetabulum", 0.15}, Case{"molar", 0.018},
                                         Case{"femoral_canal", 0.15}, Case{"sawbone_block", 0.06},
                                         Case{"thin_plate", 0.08}),
                         [](const auto& tested) { return std::string(tested.param.scene); });

// The fine cells reach half a spacing deeper than the cut. If they did not, a row of cells beside the hole
// would change from fine to coarse between the two spacings of this test, and the error would be 1.37 times
// the predicted error.
TEST(PlanLevel, TheErrorStaysNearThePredictedOneAtTwoNeighbouringSpacings) {
  const auto scene =
      LoadPlanScene({.scene = "sawbone_block", .cell = {}, .config_root = OSTEON_SOURCE_DIR "/config"});
  ASSERT_TRUE(scene) << scene.error();
  for (const double spacing_m : {0.55e-3, 0.565e-3}) {
    const simulation::PackingLevel level =
        MakeLevel(simulation::PackingKind::kGraded, spacing_m, 1.5, scene->cut, scene->zone_depth_m);
    const double predicted_m = PredictRemovalError(level.fine, scene->cut).total_m();
    EXPECT_LT(Measure(*scene, scene->work.tool, level).error_m, 1.15 * predicted_m);
  }
}

// Several engines take turns of 25 frames. In the first three frames of a turn the caches still contain
// another engine's data. The engine computes these frames, but their times are not used.
TEST(PlanLevel, SamplesAreTheFramesInContactExceptTheFirstThreeOfATurn) {
  const auto scene =
      LoadPlanScene({.scene = "thin_plate", .cell = {}, .config_root = OSTEON_SOURCE_DIR "/config"});
  ASSERT_TRUE(scene) << scene.error();
  const simulation::PackingLevel level =
      MakeLevel(simulation::PackingKind::kGraded, 0.5e-3, 1.5, scene->cut, scene->zone_depth_m);
  const PackedLevel packed{.level = level, .balls = PackLevel(level, *scene->work.solid, *scene->work.zone)};
  const auto runs = RunLevels(*scene, {packed}, scene->work.tool, {}, 1);
  ASSERT_TRUE(runs) << runs.error();

  simulation::Bone bone;
  bone.balls = packed.balls;
  bone.points = scene->points;
  bone.materials = scene->materials;
  const auto engine =
      gpu::VulkanEngine::Create(bone, scene->work.tool, Pose::Identity(),
                                simulation::CuttingForLevel(level, scene->cut, scene->work.cutting), {});
  ASSERT_TRUE(engine) << engine.error();
  std::size_t touching = 0, samples = 0;
  for (std::size_t k = 0; k < scene->work.cut_end; ++k) {
    const bool touches = (*engine)->Step(scene->work.frames[k]).contact_count > 0;
    touching += touches ? 1 : 0;
    samples += touches && k % 25 >= 3 ? 1 : 0;
  }
  EXPECT_EQ(runs->front().frames.size(), samples);
  EXPECT_LT(samples, touching);
  EXPECT_GT(samples, touching * 4 / 5);
}

// With a large accepted error the plan chooses a tool with fewer balls. The bone that remains between this
// tool's balls may use up to a tenth of the error.
TEST(PlanTool, AToolWithFewerBallsLeavesLessThanATenthOfTheError) {
  const auto scene =
      LoadPlanScene({.scene = "thin_plate", .cell = {}, .config_root = OSTEON_SOURCE_DIR "/config"});
  ASSERT_TRUE(scene) << scene.error();
  const ModelChoice whole = ChooseModel(*scene, 0.02e-3), thin = ChooseModel(*scene, 2e-3);
  EXPECT_EQ(whole.tool.balls.size(), scene->work.tool.balls.size());
  EXPECT_LT(thin.tool.balls.size(), scene->work.tool.balls.size());
  EXPECT_LT(thin.tool_gap_m, 0.1 * 2e-3);
}

TEST(PlanScene, TakesTheCellOfTheScenesNameOrElseTheDemo) {
  const std::filesystem::path root = OSTEON_SOURCE_DIR "/config";
  const auto plate = LoadPlanScene({.scene = "thin_plate", .cell = {}, .config_root = root});
  ASSERT_TRUE(plate) << plate.error();
  EXPECT_EQ(plate->cell_name, "thin_plate");
  EXPECT_NEAR(plate->cut.tool_radius_m, 2.0e-3, 1e-9);
  const auto cup = LoadPlanScene({.scene = "acetabulum", .cell = {}, .config_root = root});
  ASSERT_TRUE(cup) << cup.error();
  EXPECT_EQ(cup->cell_name, "demo");
  EXPECT_FALSE(LoadPlanScene({.scene = "ball:20", .cell = {}, .config_root = root}));
}

}  // namespace
}  // namespace osteon::session
