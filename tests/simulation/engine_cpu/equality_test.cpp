#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/gpu/engine/contract_bench.h"
#include "tests/simulation/engine_cpu/equal_engines.h"

// Tests that the CPU engine's results equal the reference engine's bit for bit, with every instruction set.

namespace osteon::simulation {
namespace {

constexpr double kSpindle_rad_per_s = gpu::kSpindle_rad_per_s;

/// Lower limits that show that a run was worth comparing: largest force, frames in contact, balls cut and
/// points cleared.
struct Minimum {
  double force_N;
  int touching;
  std::size_t balls, points;
};
/// Expects equal carved states, and a run that reached the minimum.
void ExpectEqualStatesAndAtLeast(EqualEngines& engines, const Minimum& least) {
  EXPECT_TRUE(engines.SameStates());
  const RunFacts& facts = engines.facts();
  std::printf("%d frames in contact, up to %.1f N, %zu balls cut, %zu split, %zu points cleared, %.1f mm^3\n",
              facts.touching, facts.max_force_N, facts.balls_cut, facts.split, facts.points_cleared,
              1e9 * engines.model().removed_volume_m3);
  EXPECT_GE(facts.max_force_N, least.force_N);
  EXPECT_GE(facts.touching, least.touching);
  EXPECT_GE(facts.balls_cut, least.balls);
  EXPECT_GE(facts.points_cleared, least.points);
}

TEST(CpuEngine, EqualsTheReferenceBitForBitWhileReamingAThousandFrames) {
  EqualEngines engines(gpu::DefaultBone(), gpu::DefaultReamer());
  gpu::Hand hand;
  for (int i = 0; i < 1000; ++i)
    ASSERT_TRUE(engines.Step(hand.Next(engines.model().F_T_W.f))) << "frame " << i << "\n"
                                                                  << engines.differences();
  ExpectEqualStatesAndAtLeast(engines, {.force_N = 100.0, .touching = 980, .balls = 500, .points = 500});
}

// The hand's force exceeds the edge force only in soft tissue.
TEST(CpuEngine, EqualsTheReferenceBitForBitWithAnEdgeForce) {
  Bone bone = gpu::DefaultBone();
  for (Material& material : bone.materials) {
    material.measured_chip_m = 50e-6;
    material.edge_force_N_per_m = 0.05 * material.specific_cutting_energy_J_per_m3 * material.measured_chip_m;
  }
  Tool reamer = gpu::DefaultReamer();
  for (ToolBall& ball : reamer.balls) ball.edges = 2;
  EqualEngines engines(bone, reamer, {.edge_force = true});
  gpu::Hand hand;
  for (int i = 0; i < 200; ++i)
    ASSERT_TRUE(engines.Step(hand.Next(engines.model().F_T_W.f))) << "frame " << i << "\n"
                                                                  << engines.differences();
  ExpectEqualStatesAndAtLeast(engines, {.force_N = 50.0, .touching = 150, .balls = 50, .points = 20});
}

// The bone's balls are not much smaller than the burr, so the pairs of balls that stop the burr change all
// the time.
TEST(CpuEngine, EqualsTheReferenceBitForBitWhileBurringTwoThousandFrames) {
  Tool tool;
  tool.balls.push_back({.center_m = Vector3(0, 0, 4e-3), .radius_m = 4e-3, .cutting = true});
  EqualEngines engines(gpu::DefaultBone(), tool);
  for (int i = 0; i < 2000; ++i) {
    // down into the rim, then along a figure of eight
    const double phase = 4.0 * M_PI * i / 2000.0, down = std::min(1.0, 3.0 * i / 2000.0);
    FrameInput input{.X_WT = Pose::Identity(), .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = 1e-3};
    input.X_WT.p =
        Vector3(0.029 + 1.5e-3 * std::sin(phase), 0.8e-3 * std::sin(2.0 * phase), 0.4e-3 - 2e-3 * down);
    ASSERT_TRUE(engines.Step(input)) << "frame " << i << "\n" << engines.differences();
  }
  ExpectEqualStatesAndAtLeast(engines, {.force_N = 5.0, .touching = 1500, .balls = 50, .points = 5});
}

// The tool rotates, and the spindle is switched on and off. Either all of its balls cut or only the one that
// touches first.
TEST(CpuEngine, EqualsTheReferenceBitForBitForARotatingShellOfSixtyBalls) {
  constexpr int kFrames = 250;
  for (const Cutters cutters : {Cutters::kAll, Cutters::kContactSphere}) {
    CuttingParams params;
    params.cutters = cutters;
    EqualEngines engines(gpu::DefaultBone(), gpu::Shell(60), params);
    for (int i = 0; i < kFrames; ++i) {
      const double phase = 2.0 * M_PI * i / kFrames, down = std::min(1.0, 3.0 * i / kFrames);
      Pose X = Pose::Identity();
      X.linear() = ExpRotation(Vector3(0.2 * std::sin(phase), 0.3 * std::sin(1.7 * phase), phase)) *
                   ExpRotation({M_PI, 0, 0});
      X.translation() =
          Vector3(0.029 + 1.5e-3 * std::sin(phase), 0.8e-3 * std::sin(2.0 * phase), 0.9e-3 - 3e-3 * down);
      const FrameInput input{
          .X_WT = X, .spindle_rad_per_s = i % 50 < 40 ? kSpindle_rad_per_s : 0.0, .dt_s = 1e-3};
      ASSERT_TRUE(engines.Step(input)) << "frame " << i << "\n" << engines.differences();
    }
    ExpectEqualStatesAndAtLeast(engines, {.force_N = 1.0, .touching = 100, .balls = 10, .points = 0});
  }
}

// The tool moves by 0.05 to 6 mm a frame: at 6 mm it leaves the range of its neighbour lists within the
// frame.
TEST(CpuEngine, EqualsTheReferenceBitForBitWithTheImmediateLaw) {
  CuttingParams params;
  params.law = RemovalLaw::kImmediate;
  EqualEngines engines(gpu::DefaultBone(), gpu::DefaultReamer(), params);
  for (int i = 0; i < 120; ++i) {
    Pose X = Pose::Identity();
    X.linear() = ExpRotation({M_PI, 0, 0});
    X.translation() = Vector3((i % 20 == 19 ? 6e-3 : 0.0) + 1e-5 * i, 0, -0.018 - 5e-5 * i);
    ASSERT_TRUE(engines.Step({.X_WT = X, .spindle_rad_per_s = kSpindle_rad_per_s, .dt_s = 1e-3}))
        << "frame " << i << "\n"
        << engines.differences();
  }
  ExpectEqualStatesAndAtLeast(engines, {.force_N = 1.0, .touching = 50, .balls = 100, .points = 50});
}

// Splitting reaches both of its limits: the pool's size and the budget of a frame.
TEST(CpuEngine, EqualsTheReferenceBitForBitWhileSplittingBalls) {
  CuttingParams params;
  params.split.on = true;
  params.split.pool_blocks = 40;
  params.split.blocks_per_frame = 3;
  Tool tool;
  for (int i = 0; i < 3; ++i)
    tool.balls.push_back({.center_m = Vector3(1.2e-3 * std::cos(2.1 * i), 1.2e-3 * std::sin(2.1 * i), 2e-3),
                          .radius_m = 2e-3 + 0.05e-3 * i});
  EqualEngines engines(gpu::DefaultBone(), tool, params);
  for (int i = 0; i < 500; ++i) {
    FrameInput input{.X_WT = Pose::Identity(), .spindle_rad_per_s = 10.0 * kSpindle_rad_per_s, .dt_s = 1e-3};
    input.X_WT.p = Vector3(0.029 + 2e-3 * std::sin(0.02 * i), 1e-3 * std::sin(0.04 * i), 0.4e-3 - 6e-6 * i);
    ASSERT_TRUE(engines.Step(input)) << "frame " << i << "\n" << engines.differences();
    if (i % 100 == 99) {
      ASSERT_TRUE(engines.SameStates()) << "frame " << i << "\n" << engines.differences();
      engines.RestoreAll();
    }
  }
  ExpectEqualStatesAndAtLeast(engines, {.force_N = 1.0, .touching = 100, .balls = 10, .points = 0});
  EXPECT_GT(engines.facts().split, 10u);
}

}  // namespace
}  // namespace osteon::simulation
