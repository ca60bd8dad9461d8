// Tests the reactions to a hand that pushes harder than the coupling's force limit. Also tests the limits on
// the energy and power that the coupling gives back to the hand.

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "control/laws/twist_parts.h"
#include "servo_bench.h"

namespace osteon::control {
namespace {

using safety::Fault;
using safety::OnForceLimit;

constexpr double kLimit_N = 80.0, kPush_N = 120.0;

// The bench with a force limit of 80 N and this reaction.
ServoParams Limited(OnForceLimit reaction) {
  ServoParams params = ServoBench::Params();
  params.wrench.max_force_N = kLimit_N;
  params.on_force_limit.reaction = reaction;
  return params;
}

// Pushes the tool into the plane for 3 s, with a force that rises to 120 N.
// @returns how much deeper the tool gets than the depth at which the force limit is reached [m]
double DepthBeyondLimit(ServoBench& bench) {
  const double at_limit_m = kLimit_N / ServoBench::Params().coupling.max_stiffness_N_per_m;
  bench.Run(5);
  bench.Activate();
  double max_m = 0.0;
  for (int i = 0; i < 3000; ++i) {
    bench.push_N = std::min(kPush_N, 0.15 * i);
    const TickRecord record = bench.Tick();
    max_m = std::max(max_m, record.tool_in_bone_m - at_limit_m);
    EXPECT_LE(Vector3(record.F_coupling_T_W.f).norm(), kLimit_N) << i;
    if (testing::Test::HasFailure()) break;
  }
  return max_m;
}

TEST(ServoForceLimit, SlowLetsTheToolEnterHardlyDeeperThanTheLimit) {
  ServoBench bench(Limited(OnForceLimit::kSlow));
  EXPECT_LT(DepthBeyondLimit(bench), 0.6e-3);
  EXPECT_FALSE(bench.loop.faults().Any());
  EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kBoneEntry).ticks, 100u);
  EXPECT_NEAR(bench.loop.statistics().peak_tool_in_bone_m, 4.5e-3, 0.2e-3);
}

TEST(ServoForceLimit, YieldLetsTheToolEnterDeeply) {
  ServoBench bench(Limited(OnForceLimit::kYield));
  EXPECT_GT(DepthBeyondLimit(bench), 10e-3);
  EXPECT_EQ(bench.loop.statistics().limits.Of(safety::Limit::kBoneEntry).ticks, 0u);
}

TEST(ServoForceLimit, StopStopsTheCellWithItsOwnFault) {
  ServoBench bench(Limited(OnForceLimit::kStop));
  DepthBeyondLimit(bench);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kForceLimit));
  EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
}

TEST(ServoForceLimit, AToolTooDeepInBoneStopsWithEveryReaction) {
  for (const OnForceLimit reaction : {OnForceLimit::kYield, OnForceLimit::kSlow}) {
    ServoParams params = Limited(reaction);
    params.on_force_limit.max_tool_in_bone_m = 4.2e-3;
    ServoBench bench(params);
    const double beyond_m = DepthBeyondLimit(bench);
    EXPECT_TRUE(bench.loop.faults().Has(Fault::kToolInBone));
    EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
    EXPECT_LT(beyond_m, 2e-3) << "braked at once";
  }
}

// Work of the coupling, computed independently of the loop: the recorded force times the commanded motion of
// the tool.
class CouplingWork {
 public:
  // Adds a tick. The tick's force acts at the tool's previous pose. The motion of the tick leads from that
  // pose to the recorded pose.
  void Add(const TickRecord& record) {
    const Wrench F = record.F_coupling_T_W;
    if (begun_) {
      // uses the mean of the forces at both ends of the previous step
      sum_J_ += 0.5 * (Power(F_before_, step_) + Power(F, step_));
      min_J_ = std::min(min_J_, sum_J_);
      step_ = SmallStep(X_before_, Pose(record.X_WT_cmd));
    }
    F_before_ = F;
    begun_ = true;
    X_before_ = record.X_WT_cmd;
  }
  // Work that the force of the last tick does on the step that it caused.
  [[nodiscard]] double step_J() const { return Power(F_before_, step_); }
  // Energy given back since the moment at which the coupling had taken in the most.
  [[nodiscard]] double GivenBack_J() const { return sum_J_ - min_J_; }

 private:
  bool begun_{false};
  Pose X_before_{Pose::Identity()};
  Wrench F_before_;
  Twist step_;
  double sum_J_{0.0}, min_J_{0.0};
};

TEST(ServoEnergyLimit, TheCouplingGivesBackNoMoreThanTheEnergyLimit) {
  ServoParams params = ServoBench::Params();
  params.on_force_limit.reaction = OnForceLimit::kYield;
  params.energy.max_stored_J = 0.25;
  params.workspace.sphere_radius_m = 0.4;
  ServoBench bench(params, 0.002);
  bench.Run(5);
  bench.Activate();
  CouplingWork work;
  for (int i = 0; i < 1500; ++i) {  // pushes far into the bone
    bench.push_N = std::min(130.0, 1.0 * i);
    work.Add(bench.Tick());
  }
  ASSERT_GT(bench.Depth(), 0.03);
  ASSERT_FALSE(bench.loop.faults().Any());
  for (int i = 0; i < 6000 && bench.Depth() > 0.0; ++i) {  // pulled out slowly
    bench.push_N = -2.0;
    work.Add(bench.Tick());
  }
  EXPECT_GT(work.GivenBack_J(), 0.05) << "a spring still";
  EXPECT_LE(work.GivenBack_J(), 0.25 * 1.01);
}

TEST(ServoPowerLimit, NoTickExceedsThePowerLimit) {
  for (const double limit_W : {1.0, 5.0, 25.0}) {
    ServoParams params = ServoBench::Params();
    params.energy.max_power_W = limit_W;
    params.twist.max_speed_m_per_s = 0.5;
    ServoBench bench(params, 0.002);
    bench.Run(5);
    bench.Activate();
    CouplingWork work;
    double max_W = 0.0;
    for (int i = 0; i < 3000; ++i) {
      // the hand presses and releases suddenly, again and again
      bench.push_N = i % 600 < 400 ? std::min(150.0, 1.0 * (i % 600)) : -20.0;
      work.Add(bench.Tick());
      max_W = std::max(max_W, work.step_J() / 1e-3);
    }
    ASSERT_FALSE(bench.loop.faults().Any());
    EXPECT_LE(max_W, limit_W * 1.01) << limit_W;
    if (limit_W <= 5.0) {
      EXPECT_GT(max_W, 0.9 * limit_W) << "and no less than it may";
      EXPECT_GT(bench.loop.statistics().limits.Of(safety::Limit::kPower).ticks, 0u);
    }
    EXPECT_NEAR(bench.loop.statistics().peak_power_W, max_W, 0.02 * limit_W);
  }
}

}  // namespace
}  // namespace osteon::control
