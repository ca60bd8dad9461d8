// The stabilisers in the servo loop: which ones act, and what is recorded; inactive ones leave no trace.

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/control/loop/servo_bench.h"

namespace osteon::control {
namespace {

ServoParams Params(bool act, double tool_radius_m) {
  ServoParams params = ServoBench::Params();
  params.stabilisers.age_governor.acts = act;
  params.stabilisers.age_governor.tool_radius_m = tool_radius_m;
  params.stabilisers.passivity.acts = act;
  params.stabilisers.energy_tank.acts = act;
  return params;
}

TEST(ServoStabilisers, PlanesOfTenMillisecondsRaiseTheDampingAndAreCounted) {
  ServoBench bench(Params(true, 0.025));
  bench.frame_ticks = 10;
  bench.Run(3);
  bench.Activate();
  bench.push_N = 80.0;
  double most = 1.0, least_J = 1.0;
  std::uint64_t ticks = 0;
  for (int i = 0; i < 1500; ++i) {
    const TickRecord record = bench.Tick();
    ASSERT_EQ(record.faults, 0u);
    if (record.age_damping_factor > 1.0) ++ticks;
    most = std::max(most, record.age_damping_factor);
    if (record.phase == Phase::kHaptic) least_J = std::min(least_J, record.tank_J);
    EXPECT_EQ(record.age_wrench_share, 1.0);
  }
  // 80 N / 25 mm, 10 ms: 33 N s/m at the apex' 20, and the lever of the tool's centre
  EXPECT_GT(most, 1.4);
  EXPECT_LT(most, 2.5);
  const ServoStatistics& s = bench.loop.statistics();
  EXPECT_EQ(s.limits.Of(safety::Limit::kAgeGovernor).ticks, ticks);
  EXPECT_GE(s.limits.Of(safety::Limit::kAgeGovernor).events, 1u);
  EXPECT_EQ(s.limits.Of(safety::Limit::kPassivity).events, 0u);
  EXPECT_EQ(s.limits.Of(safety::Limit::kTank).events, 0u);
  EXPECT_EQ(s.min_tank_J, least_J);
  EXPECT_GT(least_J, 0.9);
}

TEST(ServoStabilisers, WhatDoesNotActChangesNoBit) {
  ServoBench with(Params(true, 1.0)), without(Params(false, 1.0));
  for (ServoBench* bench : {&with, &without}) {
    bench->Run(3);
    bench->Activate();
    bench->push_N = 80.0;
  }
  for (int i = 0; i < 1500; ++i) {
    const TickRecord a = with.Tick(), b = without.Tick();
    ASSERT_EQ(a.q_cmd, b.q_cmd) << i;
    ASSERT_EQ(Vector3(a.F_coupling_T_W.f), Vector3(b.F_coupling_T_W.f)) << i;
  }
  EXPECT_GT(with.loop.statistics().peak_coupling_force_N, 50.0);
  EXPECT_EQ(with.loop.statistics().limits.Of(safety::Limit::kAgeGovernor).ticks, 0u);
}

TEST(ServoStabilisers, TheImpedanceLawsGovernorNeedsADamping) {
  ServoParams params = ServoBench::Params();
  params.law = Law::kImpedance;
  params.impedance.damping_Ns_per_m.setZero();
  EXPECT_THROW(ServoBench{params}, std::invalid_argument);
  params.stabilisers.age_governor.arm_damping_Ns_per_m = 50.0;
  EXPECT_NO_THROW(ServoBench{params});
}

}  // namespace
}  // namespace osteon::control
