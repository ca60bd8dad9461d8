#include <bit>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "control/loop/loop_repeat.h"
#include "servo_bench.h"

// Tests changes of gains while the loop renders.

namespace osteon::control {
namespace {

// Gains with a softer spring, other masses and more damping than the bench's.
Gains SofterGains() {
  ServoParams params = ServoBench::Params();
  params.coupling.max_stiffness_N_per_m = 8e3;
  params.admittance.mass_kg = {2.0, 4.0, 2.0};
  params.admittance.inertia_kg_m2 *= 1.5;
  params.admittance.damping_Ns_per_m.setConstant(60.0);
  return GainsOf(params.admittance, params.coupling);
}

struct PressedRun {
  std::vector<TickRecord> ticks;
  std::vector<simulation::ContactModel> models;
};

// A hand presses the tool onto the plane with 60 N for 6 s, then pulls back. Another thread requests softer
// gains after 2 s, and the original gains after 4 s.
PressedRun Press() {
  ServoParams params = ServoBench::Params();
  params.admittance.damping_Ns_per_m.setConstant(100.0);
  const Gains first = GainsOf(params.admittance, params.coupling);
  ServoBench bench(params);
  bench.Activate();
  PressedRun run;
  for (int i = 0; i < 7000; ++i) {
    bench.push_N = i < 6000 ? 60.0 : -20.0;
    if (i == 2000) std::thread([&] { bench.loop.RequestGains(SofterGains()); }).join();
    if (i == 4000) std::thread([&] { bench.loop.RequestGains(first); }).join();
    run.ticks.push_back(bench.Tick());
    run.models.push_back(bench.model);
  }
  return run;
}

TEST(ServoGains, AChangeUnderForceCausesNoStepAndNoFault) {
  const PressedRun run = Press();
  const double press_N = 60.0;
  double max_step_N = 0.0;
  for (std::size_t i = 1; i < run.ticks.size(); ++i) {
    ASSERT_EQ(run.ticks[i].faults, 0u) << i;
    const double change =
        (Vector3(run.ticks[i].F_coupling_T_W.f) - Vector3(run.ticks[i - 1].F_coupling_T_W.f)).norm();
    if (i > 1900 && i < 6000) max_step_N = std::max(max_step_N, change);
  }
  EXPECT_LT(max_step_N, 0.02 * press_N) << "ramped over a second";
  EXPECT_TRUE(run.ticks[2000].input.has_gains);
  EXPECT_TRUE(run.ticks[4000].input.has_gains);
  EXPECT_EQ(run.ticks[2000].input.gains.max_stiffness_N_per_m, 8e3);
  EXPECT_FALSE(run.ticks[2001].input.has_gains) << "in the tick that took them";

  // at rest the spring carries the push: depth = push / stiffness
  const ServoBench bench;
  const auto depth = [&](std::size_t tick) {
    return bench.feed_W.dot(Pose(run.ticks[tick].X_WT_cmd).translation() - bench.plane_W);
  };
  EXPECT_NEAR(depth(1990), press_N / 20e3, 0.02 * press_N / 20e3);
  EXPECT_NEAR(depth(3990), press_N / 8e3, 0.02 * press_N / 8e3);
  EXPECT_NEAR(depth(5990), press_N / 8e3, 0.02 * press_N / 8e3) << "stiffer again only once it is let go";
  EXPECT_LT(depth(6990), 0.0);
}

// Compares two runs bit for bit. A third loop replays the first run from its records.
TEST(ServoGains, ARunWithChangedGainsIsRepeatableAndReplayable) {
  const PressedRun once = Press(), twice = Press();
  ServoParams params = ServoBench::Params();
  params.admittance.damping_Ns_per_m.setConstant(100.0);
  ServoLoop loop(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                 ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  ArmCommand command;
  for (std::size_t i = 0; i < once.ticks.size(); ++i) {
    const TickRecord& a = once.ticks[i];
    const TickRecord again = ReplayTick(loop, a, once.models[i], command);
    for (std::size_t j = 0; j < 7; ++j) {
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a.q_cmd[j]),
                std::bit_cast<std::uint64_t>(twice.ticks[i].q_cmd[j]));
      ASSERT_EQ(std::bit_cast<std::uint64_t>(a.q_cmd[j]), std::bit_cast<std::uint64_t>(again.q_cmd[j])) << i;
    }
    ASSERT_EQ(a.input.has_gains, again.input.has_gains);
  }
}

// A tool moves freely with hardly any damping while its mass rises from 3 to 12 kg. With the same energy, it
// then has half the speed.
TEST(ServoGains, ACoastingToolThatGetsHeavierSlowsDown) {
  ServoParams params = ServoBench::Params();
  params.admittance.damping_Ns_per_m.setConstant(1e-3);
  ServoBench bench(params, 0.5);
  bench.Activate();
  bench.Run(200);  // until the coupling has faded in
  bench.push_N = -6.0;
  bench.Run(50);
  bench.push_N = 0.0;
  const double before_m_per_s = Vector3(bench.Run(10).v_WT_cmd_m_per_s).norm();
  Gains heavier = GainsOf(params.admittance, params.coupling);
  heavier.mass_kg = Vector3(12.0, 12.0, 12.0);
  bench.loop.RequestGains(heavier);
  const TickRecord after = bench.Run(1100);
  EXPECT_EQ(after.faults, 0u);
  EXPECT_GT(before_m_per_s, 0.05);
  const double left = Vector3(after.v_WT_cmd_m_per_s).norm() / before_m_per_s;
  EXPECT_LE(left, 0.5 * 1.001) << "four times the mass: no more than the energy it had";
  EXPECT_GT(left, 0.4) << "what the arm's turning posture takes on the way";
}

TEST(ServoGains, RefusesGainsOutOfRange) {
  ServoBench bench;
  const Gains own = GainsOf(ServoBench::Params().admittance, ServoBench::Params().coupling);
  Gains stiffer = own, none = own;
  stiffer.max_stiffness_N_per_m = 21e3;
  none.mass_kg.y = 0.0;
  EXPECT_THROW(bench.loop.RequestGains(stiffer), std::invalid_argument);
  EXPECT_THROW(bench.loop.RequestGains(none), std::invalid_argument);
  EXPECT_NO_THROW(bench.loop.RequestGains(own));
}

}  // namespace
}  // namespace osteon::control
