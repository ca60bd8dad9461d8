#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "simulation/engine/reference_engine.h"
#include "simulation/fidelity/frame_workload.h"

// Tests of the workloads that engines are timed with: a simulated hand that presses the tool into bone, or a
// recorded motion.

namespace osteon::simulation {
namespace {

// The hand is a mass with drag: M a = F - D v has v = F / D (1 - exp(-D t / M)) from rest. The error of an
// implicit step of 1 ms is of the order D dt / 2M, 5 %.
TEST(PressingHand, WithoutContactApproachesForceOverDrag) {
  PressingHandParams params{.force_N = 60.0, .ramp_N_per_s = 1e9, .mass_kg = 3.0, .drag_Ns_per_m = 300.0};
  PressingHand hand(params);
  FrameInput input;
  for (int k = 0; k < 11; ++k) input = hand.Next(Vector3::Zero());  // the first frame's push is still zero
  EXPECT_NEAR(hand.speed_m_per_s(), 0.2 * (1.0 - std::exp(-1.0)), 0.2 * 0.05);
  for (int k = 0; k < 500; ++k) input = hand.Next(Vector3::Zero());
  EXPECT_NEAR(hand.speed_m_per_s(), 0.2, 1e-9);
  EXPECT_NEAR(Pose(input.X_WT).translation().z(), hand.feed_m(), 1e-12);
  EXPECT_EQ(input.stamp, 510 * rt::kMillisecond);
}

TEST(PressingHand, RestsWhereASpringBalancesItsForce) {
  PressingHand hand({.force_N = 100.0, .ramp_N_per_s = 400.0});
  Vector3 force = Vector3::Zero();
  for (int k = 0; k < 3000; ++k) {
    (void)hand.Next(force);
    force = Vector3(0, 0, -20e3 * hand.feed_m());
  }
  EXPECT_NEAR(hand.feed_m(), 100.0 / 20e3, 1e-9);
}

TEST(PressingHand, RefusesZeroMassNegativeTimeAndNanDrag) {
  EXPECT_THROW(PressingHand({.mass_kg = 0.0}), std::invalid_argument);
  EXPECT_THROW(PressingHand({.dt_s = -1e-3}), std::invalid_argument);
  EXPECT_THROW(PressingHand({.drag_Ns_per_m = NAN}), std::invalid_argument);
}

// A coarse cup on the reference engine: the hand reams with 100 N until the head's centre is at the cup's
// centre, to within one frame's travel. A copy of the player then gives the same input as the player.
TEST(FrameWorkload, ReamsUntilTheHeadIsSeatedInTheCup) {
  FrameWorkloadParams params = CupWorkload();
  params.spheres = 5000;
  params.scene.points.cells.finest_m = 2e-3;
  const FrameWorkload work = MakeFrameWorkload(params);
  EXPECT_EQ(work.bone.balls.size(), 5000u);
  EXPECT_EQ(work.cutting_balls, 1u);
  EXPECT_GT(work.cut_zone_m, 1e-3);
  ReferenceEngine engine(work.bone, work.tool, Pose::Identity(), work.cutting);
  WorkloadPlayer player(work);
  ContactModel last;
  ASSERT_TRUE(RunUntilReady(engine, player, last));
  const double head_z_m = (Pose(last.X_WP) * Vector3(work.tool.balls.front().center_m)).z();
  EXPECT_NEAR(head_z_m, 0.0, 0.03e-3 + 100.0 / work.cutting.stiffness_N_per_m);
  EXPECT_NEAR(Vector3(last.F_T_W.f).norm(), 100.0, 10.0);
  // When seated, a reamer of 25 mm has removed at least the shell between its hemisphere and the cup's of 24
  // mm. A coarse packing lacks some of the shell at the rim.
  const double shell_m3 = 2.0 / 3.0 * M_PI * (std::pow(25e-3, 3) - std::pow(24e-3, 3));
  EXPECT_GT(last.removed_volume_m3, 0.9 * shell_m3);

  WorkloadPlayer copy = player;
  const FrameInput a = player.Next(last), b = copy.Next(last);
  EXPECT_EQ(Pose(a.X_WT).matrix(), Pose(b.X_WT).matrix());
  EXPECT_FALSE(player.AtEnd());
}

// The motion lasts 0.2 s; measuring begins at contact, so fewer than 201 frames of 1 ms remain.
TEST(FrameWorkload, PlaysARecordedMotionToItsEnd) {
  FrameWorkloadParams params = CupWorkload();
  params.spheres = 300;
  params.scene.points.cells.finest_m = 3e-3;
  ToolMotion motion;
  const Eigen::Quaterniond down(Eigen::AngleAxisd(M_PI, Vector3::UnitX()));
  motion.samples = {{.time_s = 0.0, .p_GT_m = {0, 0, -0.010}, .R_GT = down},
                    {.time_s = 0.2, .p_GT_m = {0, 0, -0.030}, .R_GT = down}};
  params.motion = motion;
  const FrameWorkload work = MakeFrameWorkload(params);
  ReferenceEngine engine(work.bone, work.tool, Pose::Identity(), work.cutting);
  WorkloadPlayer player(work);
  ContactModel last;
  ASSERT_TRUE(RunUntilReady(engine, player, last));
  EXPECT_GT(Vector3(last.F_T_W.f).norm(), 0.0);
  int frames = 0;
  for (; !player.AtEnd(); ++frames) last = engine.Step(player.Next(last));
  EXPECT_GT(frames, 20);
  EXPECT_LT(frames, 201);
}

TEST(TimeFigures, PercentilesAreByNearestRank) {
  std::vector<double> times;
  for (int i = 1000; i >= 1; --i) times.push_back(i);
  const TimeFigures figures = FiguresOf(times);
  EXPECT_EQ(figures.p50_us, 500.0);
  EXPECT_EQ(figures.p95_us, 950.0);
  EXPECT_EQ(figures.p99_us, 990.0);
  EXPECT_EQ(figures.p999_us, 999.0);
  EXPECT_EQ(figures.max_us, 1000.0);
  EXPECT_EQ(FiguresOf({}).max_us, 0.0);
  EXPECT_EQ(FiguresOf({7.0}).p50_us, 7.0);
}

}  // namespace
}  // namespace osteon::simulation
