#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/fidelity/arm_level.h"
#include "simulation/fidelity/frame_cost.h"
#include "simulation/fidelity/packing_level.h"
#include "simulation/fidelity/scene_workload.h"
#include "simulation/fidelity/thin_tool.h"
#include "simulation/tools/swept_tool.h"
#include "simulation/tools/tool_kinds.h"
#include "tests/oracles/depth_table.h"

// Tests of the parts of a resolution plan: the levels of packing and arm, a tool with fewer balls, the time
// that a frame takes, and the workload of a scene.

namespace osteon::simulation {
namespace {

/// A drilled hole of radius 2 mm and a reamed cup of radius 25 mm.
const CutShape kHole{.tool_radius_m = 2e-3, .rim_per_area_1_per_m = 50.0, .area_m2 = 250e-6};
const CutShape kCup{.tool_radius_m = 25e-3,
                    .along_surface = true,
                    .depth_m = 4e-3,
                    .rim_per_area_1_per_m = 40.0,
                    .area_m2 = 3900e-6};

TEST(PackingLevel, CoarsestLevelIsTheCoarsestThatMeetsTheError) {
  for (const CutShape& cut : {kHole, kCup})
    for (const PackingKind kind : {PackingKind::kGraded, PackingKind::kSplit})
      for (const double error_m : {0.01e-3, 0.02e-3, 0.03e-3}) {
        const auto level = CoarsestLevel(kind, error_m, cut, 1e-3);
        ASSERT_TRUE(level) << KindName(kind);
        EXPECT_LE(PredictRemovalError(level->fine, cut).total_m(), error_m);
        // a level 2 % coarser exceeds the error, or the range in which the closed forms hold
        const PackingLevel coarser = Scaled(*level, 1.02, cut);
        const bool beyond = PredictRemovalError(coarser.fine, cut).total_m() > error_m,
                   large = coarser.fine.radius_m > 0.6 * cut.tool_radius_m ||
                           coarser.fine.spacing_m > 0.75 * cut.tool_radius_m ||
                           (cut.along_surface && coarser.fine.spacing_m > 0.85 * cut.depth_m);
        EXPECT_TRUE(beyond || large) << KindName(kind) << " " << error_m;
      }
  EXPECT_FALSE(CoarsestLevel(PackingKind::kGraded, 1e-9, kHole, 0.0)) << "finer than any packing";
}

// The wall is 0.6 mm thick, so balls may have a radius of 0.3 mm at most.
TEST(PackingLevel, BallsAreLimitedByTheWallsThickness) {
  CutShape plate = kHole;
  plate.wall_m = 0.6e-3;
  for (const PackingKind kind : {PackingKind::kUniform, PackingKind::kGraded, PackingKind::kSplit}) {
    const auto level = CoarsestLevel(kind, 0.2e-3, plate, 0.0);
    ASSERT_TRUE(level);
    EXPECT_LE(level->fine.radius_m, 0.3e-3);
    EXPECT_TRUE(FitsWall(*level, plate));
    EXPECT_FALSE(FitsWall(Scaled(*level, 2.0, plate), plate)) << "smaller balls would leave holes";
  }
}

TEST(PackingLevel, ExpectedNumberOfBallsIsNearThePackedNumber) {
  const DepthScene scene = MakeCupScene();
  const DepthVolumes volumes(*scene.solid, *scene.zone);
  EXPECT_NEAR(volumes.volume_m3(), 2.0 / 3.0 * M_PI * (std::pow(33e-3, 3) - std::pow(25e-3, 3)),
              0.06 * volumes.volume_m3());
  for (const PackingKind kind : {PackingKind::kUniform, PackingKind::kGraded, PackingKind::kSplit}) {
    const PackingLevel level = MakeLevel(kind, 2.5e-3, 1.2, kCup, 3e-3);
    const double packed = static_cast<double>(PackLevel(level, *scene.solid, *scene.zone).size());
    EXPECT_NEAR(volumes.ExpectedBalls(level), packed, 0.5 * packed) << KindName(kind);
  }
}

TEST(ThinTool, DropsBallsWithinTheGapAndReportsTheMeanGap) {
  const Tool drill = MakeTwistDrill({.diameter_m = 4e-3}).tool;
  EXPECT_EQ(ThinTool(drill, 0.0).balls.size(), drill.balls.size());
  EXPECT_LT(MeanCuttingGap(drill, drill), 1e-15);
  const Tool thin = ThinTool(drill, 0.3e-3);
  EXPECT_LT(thin.balls.size(), drill.balls.size());
  const double gap = MeanCuttingGap(drill, thin);
  EXPECT_GT(gap, 0.0);
  EXPECT_LT(gap, 0.3e-3);
  // the head, and some balls with and some without a cutting edge, remain
  EXPECT_EQ(CuttingHead(thin)->radius_m, CuttingHead(drill)->radius_m);
  EXPECT_EQ(CuttingReach(thin), CuttingReach(drill));
  std::set<bool> kinds;
  for (const ToolBall& ball : thin.balls) kinds.insert(ball.cutting);
  EXPECT_EQ(kinds.size(), 2u);
  // a cutting ball may not replace a ball without a cutting edge, even one inside it
  Tool both = drill;
  both.balls = {{.center_m = Vector3(0, 0, -5e-3), .radius_m = 5e-3, .cutting = true},
                {.center_m = Vector3(0, 0, -4e-3), .radius_m = 2e-3, .cutting = false}};
  EXPECT_EQ(ThinTool(both, 0.1e-3).balls.size(), 2u);
  EXPECT_THROW((void)ThinTool(drill, -1e-6), std::invalid_argument);
  EXPECT_THROW((void)ThinTool(drill, NAN), std::invalid_argument);
}

// Frames take 200 us and 0.05 us for each active ball; a tenth of them was interrupted and takes 9 ms.
TEST(FrameCost, FitsALineAndIgnoresInterruptedFrames) {
  std::vector<FrameGroup> groups;
  for (const double active : {1000.0, 4000.0}) {
    std::vector<FrameSample> samples;
    for (int k = 0; k < 100; ++k)
      samples.push_back({.us = 200.0 + 0.05 * active + (k % 5), .active_balls = active, .waited_us = 19.0});
    for (int k = 0; k < 10; ++k)
      samples.push_back({.us = 9000.0, .active_balls = active, .waited_us = 8000.0});
    groups.push_back(GroupOf(samples));
    EXPECT_EQ(groups.back().frames, 110u);
    EXPECT_EQ(groups.back().interrupted, 10u);
    EXPECT_EQ(groups.back().active_balls, active);
    EXPECT_LT(groups.back().p999_us, 500.0) << "an interrupted frame is none of the model's";
  }
  const FrameCost cost = FitFrameCost(groups);
  EXPECT_NEAR(cost.ball_us, 0.05, 1e-6);
  EXPECT_NEAR(cost.At(2000.0), groups[0].p50_us + 50.0, 1e-3);
  EXPECT_GT(cost.tail_ratio, 1.0);
}

// On few cores the threads wait for each other, so nearly all frames are treated as interrupted. The median
// must be that of all frames, but the 99.9th percentile that of the ten uninterrupted frames.
TEST(FrameCost, MedianIsOfAllFramesAndTheTailOfUninterruptedOnes) {
  std::vector<FrameSample> samples;
  for (int k = 0; k < 900; ++k)
    samples.push_back({.us = 200.0 + k % 10, .active_balls = 1000.0, .waited_us = 45.0});
  for (int k = 0; k < 100; ++k)
    samples.push_back({.us = 1000.0 + k, .active_balls = 1000.0, .waited_us = 45.0});
  for (int k = 0; k < 10; ++k) samples.push_back({.us = 220.0, .active_balls = 1000.0, .waited_us = 5.0});
  const FrameGroup group = GroupOf(samples);
  EXPECT_NEAR(group.p50_us, 205.0, 2.0);
  EXPECT_EQ(group.interrupted, 1000u);
  EXPECT_EQ(group.p999_us, 220.0);
  // if every frame is interrupted, all are used
  for (FrameSample& sample : samples) sample.waited_us = 100.0;
  EXPECT_EQ(GroupOf(samples).interrupted, samples.size());
  EXPECT_GT(GroupOf(samples).p999_us, 1000.0);
}

// Measured medians that fall with the number of balls, or rise so steeply that the base would be negative.
TEST(FrameCost, BaseAndCostOfABallAreNeverNegative) {
  const FrameCost falling = FitFrameCost(
      std::vector<FrameGroup>{{.frames = 1, .active_balls = 100.0, .p50_us = 300.0, .p999_us = 400.0},
                              {.frames = 1, .active_balls = 1000.0, .p50_us = 200.0, .p999_us = 400.0}});
  EXPECT_EQ(falling.ball_us, 0.0);
  EXPECT_GT(falling.base_us, 200.0);
  EXPECT_LT(falling.base_us, 300.0);
  const FrameCost steep = FitFrameCost(
      std::vector<FrameGroup>{{.frames = 1, .active_balls = 100.0, .p50_us = 10.0, .p999_us = 40.0},
                              {.frames = 1, .active_balls = 200.0, .p50_us = 200.0, .p999_us = 400.0}});
  EXPECT_EQ(steep.base_us, 0.0);
  EXPECT_GT(steep.ball_us, 0.0);
  EXPECT_THROW((void)FitFrameCost(std::vector<FrameGroup>(1)), std::invalid_argument);
  EXPECT_THROW((void)FitFrameCost(std::vector<FrameGroup>(2)), std::invalid_argument);
  EXPECT_THROW((void)GroupOf({}), std::invalid_argument);
}

// The kinematic level ignores the arm's delay and its deflection under force, the servo level only the
// deflection.
TEST(ArmFidelity, LowestLevelIsTheSimplestWithinTheError) {
  // lag at 5 mm/s, by a delay of 3 ms plus twice the time constant of 15 Hz: 0.121 mm; deflection by 100 N at
  // 2 N/um: 0.05 mm
  const ArmFigures arm{.stiffness_N_per_m = 2e6};
  EXPECT_NEAR(ArmError(ArmFidelity::kKinematic, arm), 0.121e-3 + 0.05e-3, 0.001e-3);
  EXPECT_DOUBLE_EQ(ArmError(ArmFidelity::kServo, arm), 0.05e-3);
  EXPECT_EQ(LowestArmLevel(arm, 0.2e-3), ArmFidelity::kKinematic);
  EXPECT_EQ(LowestArmLevel(arm, 0.1e-3), ArmFidelity::kServo);
  EXPECT_EQ(LowestArmLevel(arm, 0.04e-3), ArmFidelity::kDynamic);
  EXPECT_EQ(LowestArmLevel({.stiffness_N_per_m = 0.0}, 0.01e-3), ArmFidelity::kServo) << "a rigid mounting";
}

/// A block of cancellous bone, 20 mm wide, with a drill path of radius 2 mm from 3 mm above its top to 6 mm
/// below.
SceneParams DrilledScene(double height_m) {
  SceneParams scene;
  scene.shape = BlockShape{.width_m = 0.02, .depth_m = 0.02, .height_m = height_m, .layers = {}};
  scene.materials = {DefaultBoneMaterials()[kCancellous]};
  scene.material_names = {scene.materials[0].name};
  scene.site = {.radius_m = 2e-3};
  scene.zone = {.kind = ZoneParams::Kind::kPath,
                .radius_m = 2e-3,
                .path_C_m = {Vector3(0, 0, 3e-3), Vector3(0, 0, -6e-3)}};
  return scene;
}

TEST(SceneWorkload, DrillsAlongTheZonesPathAndDistinguishesPlateFromBlock) {
  const Tool burr = MakeBurr({.shape = BurrShape::kRound, .diameter_m = 4e-3}).tool;
  const SceneParams plate = DrilledScene(2e-3), block = DrilledScene(20e-3);
  const CutWorkload through = MakeSceneWorkload(MakeSceneSolid(plate), plate, burr, {}),
                    blind = MakeSceneWorkload(MakeSceneSolid(block), block, burr, {});
  const auto head_z = [&](const CutWorkload& work, std::size_t k) {
    return (Pose(work.frames[k].X_WT) * Vector3(CuttingHead(burr)->center_m)).z();
  };
  EXPECT_NEAR(head_z(through, 0), 3e-3, 1e-12);
  EXPECT_NEAR(head_z(through, through.cut_end - 1), -6e-3, 1e-12);
  for (std::size_t k = 0; k < through.frames.size(); ++k)
    EXPECT_EQ(through.frames[k].spindle_rad_per_s != 0.0, k < through.cut_end);
  EXPECT_EQ(through.materials[0].friction, 0.0);

  const CutShape out = ShapeOfCut(through, plate), in = ShapeOfCut(blind, block);
  EXPECT_NEAR(out.wall_m, 2e-3, 0.05e-3);
  EXPECT_NEAR(out.rim_per_area_1_per_m, 1000.0, 30.0) << "two rims to 2 mm";
  EXPECT_EQ(in.wall_m, 0.0);
  // 6 mm of hole with a hemisphere at its end: its area is 2 pi R (6 mm + R), its rim 2 pi R
  EXPECT_NEAR(in.area_m2, 2.0 * M_PI * 2e-3 * 8e-3, 0.01 * in.area_m2);
  EXPECT_NEAR(in.rim_per_area_1_per_m, 1.0 / 8e-3, 2.0);
  EXPECT_EQ(ZoneDepthFor(in, 2e-3), 0.0);
  EXPECT_NEAR(ZoneDepthFor(in, 1.5e-3), 0.5e-3, 1e-9);
}

TEST(SceneWorkload, ReamsACupToItsZonesDepthAndRefusesScenesWithoutAPath) {
  SceneParams scene;
  scene.shape = AcetabulumShape{};
  scene.material_names = MaterialNames(scene.shape);
  scene.materials = DefaultBoneMaterials();
  scene.materials.resize(scene.material_names.size());
  const Tool reamer = MakeReamer(ReamerParams{}).tool;
  const CutWorkload work = MakeSceneWorkload(MakeSceneSolid(scene), scene, reamer, {});
  const double deepest = -SweptTool(reamer, work.CutPath()).Bounds().min().z() -
                         std::get<AcetabulumShape>(scene.shape).cup_radius_m;
  EXPECT_NEAR(deepest, scene.packing.cup_depth_m, 1e-6);
  EXPECT_TRUE(ShapeOfCut(work, scene).along_surface);

  scene.zone.kind = ZoneParams::Kind::kEverywhere;
  EXPECT_THROW((void)MakeSceneWorkload(MakeSceneSolid(scene), scene, reamer, {}), std::invalid_argument);
  scene.zone.kind = ZoneParams::Kind::kCup;
  Tool blunt = reamer;
  for (ToolBall& ball : blunt.balls) ball.cutting = false;
  EXPECT_THROW((void)MakeSceneWorkload(MakeSceneSolid(scene), scene, blunt, {}), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
