#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "config/reading/load.h"
#include "studies/tune/tune_study.h"

// The computations of `osteon tune`: least drag, gain margin, stiffest wall, and runs in time.

namespace osteon::studies {
namespace {

TuneTask DemoTask() {
  return TuneTaskOf(config::LoadCell(std::filesystem::path(OSTEON_SOURCE_DIR) / "config/cells/demo.yaml"));
}

TEST(TuneStudy, ReadsTheLoopFromTheCell) {
  const TuneTask task = DemoTask();
  EXPECT_DOUBLE_EQ(task.loop.arm.bandwidth_hz, 15.0);
  EXPECT_EQ(task.loop.arm.dead_cycles, 3);
  EXPECT_DOUBLE_EQ(task.loop.period_s, 1e-3);
  EXPECT_DOUBLE_EQ(task.loop.mass_kg, 1.7);
  EXPECT_DOUBLE_EQ(task.wall_N_per_m, 20e3);
  EXPECT_NEAR(task.plane_N_per_m, 200.0 / 0.025, 1e-6) << "200 N on a head of 25 mm";
}

TEST(TuneStudy, HandsReachTheGivenStiffness) {
  const auto hands = HandsUpTo(3e3);
  EXPECT_EQ(hands.front().stiffness_N_per_m, 3e3);
  for (const hil::GridHand& hand : hands) EXPECT_LE(hand.stiffness_N_per_m, 3e3);
  EXPECT_GT(hands.size(), 25u);
  EXPECT_GT(HandsUpTo(10e3).size(), hands.size());
}

// With one hand, no delays and no wall, the least drag must be that of admittance_stability_test.cpp: 28.4
// and 124.7 N s/m at 3 kg.
TEST(TuneStudy, LeastDragOfAFirmGripEqualsTheLoops) {
  TuneTask task = DemoTask();
  task.margin = 1.0;
  task.command_jitter = 0;
  task.worst_age_s = 0.0;
  task.wall_N_per_m = task.plane_N_per_m = 1.0;
  EXPECT_NEAR(MinDragFor(task, 3.0, {{"firm grip", 3e3, 20.0, 1.5}}), 28.43, 0.01 * 28.43);
  EXPECT_NEAR(MinDragFor(task, 3.0, {{"firm grip", 10e3, 20.0, 1.5}}), 124.7, 0.01 * 124.7);
}

TEST(TuneStudy, LatenessAgeAndMarginEachNeedMoreDrag) {
  TuneTask task = DemoTask();
  const auto hands = HandsUpTo(3e3);
  const double own = MinDragFor(task, 2.8, hands);
  TuneTask harder = task;
  harder.command_jitter += 3;
  EXPECT_GT(MinDragFor(harder, 2.8, hands), 1.05 * own);
  harder = task;
  harder.worst_age_s = 0.006;
  EXPECT_GT(MinDragFor(harder, 2.8, hands), 1.05 * own);
  harder = task;
  harder.margin *= 1.3;
  EXPECT_GT(MinDragFor(harder, 2.8, hands), 1.05 * own);
  // at the least drag, the margin is exactly the required one
  EXPECT_NEAR(GainMargin(task, {2.8, 1.005 * own}, hands), task.margin, 0.02 * task.margin);
  EXPECT_EQ(GainMargin(task, {2.8, 0.3 * own}, hands), 0.0);
}

TEST(TuneStudy, SimulatedStiffestWallIsThePredictedWithinOnePercent) {
  const TuneTask task = DemoTask();
  for (const double b : {40.0, 60.0}) {
    const TuneBoundary found = BoundaryAt(task, {2.0, b}, HandsUpTo(3e3), 1e6);
    ASSERT_GT(found.predicted_N_per_m, 1e3);
    ASSERT_LT(found.predicted_N_per_m, 1e6);
    EXPECT_NEAR(found.simulated_N_per_m, found.predicted_N_per_m, 0.01 * found.predicted_N_per_m) << b;
    EXPECT_LT(found.degraded_N_per_m, found.simulated_N_per_m) << b;
    // the decay rate changes its sign at that wall
    EXPECT_GT(DecayRate(task, {2.0, b}, HandsUpTo(3e3), 0.97 * found.predicted_N_per_m), 0.0);
    EXPECT_LT(DecayRate(task, {2.0, b}, HandsUpTo(3e3), 1.03 * found.predicted_N_per_m), 0.0);
  }
}

TEST(TuneStudy, RunsInTimeDetectUnstableGains) {
  const TuneTask task = DemoTask();
  const auto hands = HandsUpTo(3e3);
  const TuneCheck good = CheckInTime(task, {2.4, std::ceil(MinDragFor(task, 2.4, hands))}, hands);
  EXPECT_EQ(good.runs, 3 * hands.size());
  EXPECT_TRUE(good.grew.empty()) << good.grew.front();
  EXPECT_FALSE(CheckInTime(task, {2.4, 8.0}, hands).grew.empty());
}

TEST(TuneStudy, TheVibrationIndexCalmsHandsThatAreTooStiffForTheGains) {
  const TuneTask task = DemoTask();
  const TuneGains gains{1.7, 30.0};
  ASSERT_TRUE(task.vibration.acts);
  EXPECT_TRUE(task.index_acts) << "in the cell, too";
  EXPECT_EQ(IndexWith(task, gains, HandsUpTo(3e3)), 0.0) << "up to the grip they need no index";
  const std::vector<StiffHandRun> hands = RunStiffHands(task, gains);
  EXPECT_EQ(hands.size(), 20u) << "9 of 6 kN/m, 9 of 10 kN/m, fixture and clamp";
  for (const StiffHandRun& c : hands) {
    EXPECT_TRUE(c.Calm()) << c.hand.name << ", " << c.contact << ": " << c.run.one_s_N << " N";
    EXPECT_LT(c.run.half_s_N, 1.2 * c.calm_N) << c.hand.name;
  }
  TuneTask still = task;  // with this task no tremor is accepted
  still.vibration.reference = {};
  for (const StiffHandRun& c : RunStiffHands(still, gains)) {
    EXPECT_EQ(c.calm_N, 0.5);
    EXPECT_TRUE(c.Calm()) << c.hand.name << ", " << c.contact << ": " << c.run.one_s_N << " N";
  }
  TuneTask unaided = task;
  unaided.vibration.acts = false;
  EXPECT_TRUE(std::ranges::any_of(RunStiffHands(unaided, gains), [](const auto& c) { return !c.Calm(); }));
}

}  // namespace
}  // namespace osteon::studies
