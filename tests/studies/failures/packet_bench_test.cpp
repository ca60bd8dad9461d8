#include "studies/failures/packet_bench.h"

#include <gtest/gtest.h>

// The simulation of scenario 14 (packet loss): the condition D > a_max K (drag, largest age, stiffness) must
// distinguish growing motions from decaying ones.

namespace osteon::studies {
namespace {

PacketTrialParams WithDelay(WallMethod method, rt::Nanoseconds delay) {
  return {.method = method, .after = {.delay = delay}};
}

TEST(PacketBench, AgesAreTheDelaysThereAndBackButAtLeastATick) {
  for (const int delay_ms : {0, 1, 4}) {
    const PacketTrial trial = RunPacketTrial(WithDelay(WallMethod::kHeld, delay_ms * rt::kMillisecond));
    EXPECT_DOUBLE_EQ(trial.wall_age_s, delay_ms == 0 ? 1e-3 : 2e-3 * delay_ms) << "there and back";
    EXPECT_EQ(trial.wall_age_s, trial.hand_age_s);
  }
}

// Motion with a wall whose force is a seconds old: m x'' + D x' + K x(t - a) = 0. At the stability limit,
// with the oscillation's frequency w [rad/s], w^2 m = K cos(w a) and w D = K sin(w a).
TEST(PacketBench, HeldForcesGrowFromTheDelayThatTheoryGives) {
  // K = 20e3, D = 80, m = 3: w = 79.5 rad/s, a = 4.07 ms (the hold adds half a tick). At an age of 2 ms the
  // motion must decay, at 6 ms it must grow.
  const PacketTrialParams below_limit = WithDelay(WallMethod::kHeld, 1 * rt::kMillisecond),
                          above_limit = WithDelay(WallMethod::kHeld, 3 * rt::kMillisecond);
  const PacketTrial small = RunPacketTrial(below_limit), large = RunPacketTrial(above_limit);
  EXPECT_GT(AgeMargin(below_limit, small), 0.0);
  EXPECT_LT(small.Growth(), 1.0);
  EXPECT_LT(AgeMargin(above_limit, large), 0.0);
  EXPECT_GT(large.Growth(), 10.0);
}

TEST(PacketBench, PlanesTolerateAnAgeAtWhichForcesGrow) {
  const PacketTrialParams params = WithDelay(WallMethod::kPlanes, 10 * rt::kMillisecond);
  const PacketTrial trial = RunPacketTrial(params);
  EXPECT_GT(trial.wall_age_s, 0.019);
  EXPECT_GT(AgeMargin(params, trial), 0.0);
  EXPECT_LT(trial.Growth(), 1e-3);
}

// The planes turn as the tool moves sideways, but late by their age. The stiffness of this effect is the
// force over the clearance.
TEST(PacketBench, PlanesThatTurnTooFastForTheirAgeGrow) {
  PacketTrialParams params = WithDelay(WallMethod::kPlanes, 10 * rt::kMillisecond);
  params.clearance_m = 1e-3;  // 30 N / 1 mm = 30 kN/m, at an age of 20 ms
  const PacketTrial trial = RunPacketTrial(params);
  EXPECT_LT(AgeMargin(params, trial), 0.0);
  EXPECT_GT(trial.Growth(), 1.0);
  params.after = {};
  EXPECT_LT(RunPacketTrial(params).Growth(), 1e-3) << "of no age they rest";
}

}  // namespace
}  // namespace osteon::studies
