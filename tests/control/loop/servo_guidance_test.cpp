#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "control/coupling/coupling_pipeline.h"
#include "control/loop/loop_repeat.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_parts.h"

// Tests the guidance along a surgical plan, in the servo loop.

namespace osteon::control {
namespace {

constexpr double kHead_m = 0.022;  // radius of the head; its centre lies this far behind the apex

// A plan along the feed of the start pose. At the start, the head's centre is `height_m` above its planned
// end.
GuidanceParams PlanAhead(double height_m) {
  GuidanceParams guidance;
  const Pose X_WT = ServoBench::StartPose();
  const Vector3 feed_W = X_WT.linear().col(2);
  guidance.axis_W = -feed_W;
  guidance.head_m = kHead_m;
  guidance.centre_W = X_WT.translation() - (kHead_m - height_m) * feed_W;
  return guidance;
}

// The bench's parameters with this plan.
ServoParams GuidedParams(double height_m = 2e-3) {
  ServoParams params = ServoBench::Params();
  params.guidance = PlanAhead(height_m);
  return params;
}

// A bench whose arm is active, with the tool in free air: the bone's plane is 0.5 m ahead.
struct FreeAirBench : ServoBench {
  explicit FreeAirBench(const ServoParams& params) : ServoBench(params, 0.5) { Activate(); }
};

TEST(ServoGuidance, HoldsBackAHandThatPushesTooDeep) {
  FreeAirBench bench(GuidedParams());
  bench.push_N = 40.0;
  const TickRecord record = bench.Run(4000);
  EXPECT_EQ(record.phase, Phase::kHaptic);
  ASSERT_TRUE(record.guidance.present);
  EXPECT_EQ(record.guidance.share, 1.0);
  // 40 N / (10 N/mm), plus half of the spring's ease of 0.5 mm
  EXPECT_NEAR(record.guidance.depth_m, 4.25e-3, 0.05e-3);
  EXPECT_NEAR(Vector3(record.guidance.F_T_W.f).norm(), 40.0, 0.5);
  EXPECT_EQ(Vector3(record.F_coupling_T_W.f), Vector3(record.guidance.F_T_W.f)) << "nothing else acts";
  EXPECT_TRUE(safety::LimitSet(record.limits).Has(safety::Limit::kGuidance));
  EXPECT_LE(record.guidance.energy_J + record.guidance.share * record.guidance.potential_J, 1e-6);
}

TEST(ServoGuidance, WithoutGainItOnlyObserves) {
  ServoParams params = GuidedParams();
  params.guidance->gain = 0.0;
  FreeAirBench observed(params), without(ServoBench::Params());
  for (int tick = 0; tick < 3000; ++tick) {
    observed.push_N = without.push_N = 30.0 * std::sin(0.003 * tick);
    const TickRecord a = observed.Tick(), b = without.Tick();
    ASSERT_EQ(a.q_cmd, b.q_cmd) << tick;
    ASSERT_EQ(Vector3(a.F_coupling_T_W.f), Vector3(b.F_coupling_T_W.f));
    ASSERT_EQ(a.limits, b.limits);
    EXPECT_EQ(observed.loop.cell_commands().spindle_rad_per_s,
              without.loop.cell_commands().spindle_rad_per_s);
    if (a.phase == Phase::kHaptic) {
      EXPECT_TRUE(a.guidance.present);
      EXPECT_EQ(a.guidance.share, 0.0);
      EXPECT_FALSE(b.guidance.present);
    }
  }
}

TEST(ServoGuidance, ARequestedGainActsFromTheNextTick) {
  FreeAirBench bench(GuidedParams());
  bench.push_N = 40.0;
  ASSERT_EQ(bench.Run(4000).guidance.share, 1.0);
  bench.loop.RequestGuidanceGain(0.25);
  TickRecord record = bench.Tick();
  EXPECT_TRUE(record.input.has_guidance_gain);
  EXPECT_EQ(record.input.guidance_gain, 0.25);
  EXPECT_EQ(record.guidance.share, 0.25);
  EXPECT_FALSE(bench.Tick().input.has_guidance_gain) << "taken once";
  bench.loop.RequestGuidanceGain(7.0);
  EXPECT_EQ(bench.Tick().input.guidance_gain, 1.0) << "clamped";
  bench.loop.RequestGuidanceGain(std::nan(""));
  EXPECT_FALSE(bench.Tick().input.has_guidance_gain);
}

TEST(ServoGuidance, FadesOutWithAnOldContactModel) {
  FreeAirBench bench(GuidedParams());
  bench.push_N = 40.0;
  ASSERT_EQ(bench.Run(4000).guidance.share, 1.0);
  bench.simulation_lives = false;
  for (int i = 0; i < 100; ++i) {
    const TickRecord record = bench.Tick();
    if (!record.guidance.present) continue;
    const CouplingParams& coupling = ServoBench::Params().coupling;
    const double weight =
        std::clamp((coupling.gone_s - record.model_age_s) / (coupling.gone_s - coupling.fresh_s), 0.0, 1.0);
    EXPECT_LE(record.guidance.share, weight + 1e-9);
    if (record.model_age_s >= coupling.gone_s) {
      EXPECT_EQ(Vector3(record.guidance.F_T_W.f), Vector3(0, 0, 0));
    }
  }
}

TEST(ServoGuidance, BeyondItsStopTheSpindleStandsUntilTheToolIsInside) {
  ServoParams params = GuidedParams(10e-3);
  params.spindle_rad_per_s = 26.0;
  FreeAirBench bench(params);
  bench.Run(300);
  ASSERT_GT(bench.loop.cell_commands().spindle_rad_per_s, 0.0);
  const Vector3 aside = ServoBench::StartPose().linear().col(0);
  bool stopped = false, outside_before_stop = false;
  TickRecord record;
  for (int i = 0; i < 6000 && !stopped; ++i) {
    bench.side_W_N = 15.0 * aside;
    record = bench.Tick();
    stopped = bench.loop.cell_commands().spindle_rad_per_s == 0.0;
    outside_before_stop |= !stopped && record.guidance.lateral_m > 0.5e-3;
  }
  EXPECT_TRUE(stopped);
  EXPECT_TRUE(outside_before_stop);
  EXPECT_TRUE(record.guidance.stops_spindle);
  EXPECT_EQ(record.phase, Phase::kHaptic) << "no fault";
  bool turns_again = false;
  for (int i = 0; i < 9000 && !turns_again; ++i) {
    bench.side_W_N = -8.0 * aside;
    record = bench.Tick();
    turns_again = bench.loop.cell_commands().spindle_rad_per_s > 0.0;
    if (turns_again) {
      EXPECT_LE(record.guidance.lateral_m, 0.0);
    }
  }
  EXPECT_TRUE(turns_again);
}

TEST(ServoGuidance, EveryTickIsRepeatedIdentically) {
  const ServoParams params = GuidedParams(1e-3);
  ServoBench bench(params);
  ServoLoop second(params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
                   ServoBench::Arm().ArmAngle(ServoBench::StartJoints()));
  LoopRepeat repeat(second);
  bench.Activate();
  bool acted = false;
  for (int tick = 0; tick < 3000; ++tick) {
    bench.push_N = 60.0 * std::sin(0.01 * tick);
    bench.side_W_N = 20.0 * std::sin(0.004 * tick) * ServoBench::StartPose().linear().col(0);
    if (tick == 1200) bench.loop.RequestGuidanceGain(0.5);
    if (tick == 1500) bench.loop.RequestPause();
    if (tick == 1800) bench.loop.RequestResume();
    const TickRecord record = bench.Tick();
    acted |= record.guidance.share > 0.0 && record.guidance.potential_J > 0.0;
    repeat.StoreTick(record, bench.model);
    ASSERT_TRUE(repeat.ReplayStoredTick()) << tick;
  }
  EXPECT_TRUE(acted);
}

TEST(ServoGuidance, AChangeOfToolBringsTheNextReamersGuidanceAndKeepsTheGain) {
  LoopTool first{.X_FT = ServoBench::FlangeToTool(), .sensor = ServoBench::Params().sensor};
  first.guidance = PlanAhead(2e-3);
  LoopTool second = first;
  second.guidance = PlanAhead(1e-3);
  LoopTool third = first;
  third.guidance.reset();
  FreeAirBench bench(ServoBench::Params());
  bench.loop.SetTools({first, second, third}, 0);
  bench.push_N = 40.0;
  ASSERT_GT(bench.Run(3000).guidance.potential_J, 0.0);
  bench.loop.RequestGuidanceGain(0.5);
  bench.push_N = 0.0;
  bench.Run(10);
  const auto change = [&](int tool) {
    bench.loop.RequestPause();
    bench.Run(600);
    bench.loop.RequestTool(tool);
    const TickRecord changed = bench.Tick();
    EXPECT_EQ(changed.input.tool_index, tool);
    bench.loop.RequestResume();
    return bench.Run(30);
  };
  const double before_m = bench.Tick().guidance.depth_m;
  TickRecord record = change(1);
  ASSERT_TRUE(record.guidance.present);
  EXPECT_NEAR(record.guidance.depth_m, before_m + 1e-3, 0.5e-3) << "its end is planned 1 mm higher";
  EXPECT_EQ(record.guidance.share, 0.0) << "outside when it was switched on";
  EXPECT_EQ(record.guidance.energy_J, 0.0);
  bench.push_N = -20.0;
  record = bench.Run(2000);
  EXPECT_EQ(record.guidance.share, 0.5) << "inside again, at the gain that was asked for";
  bench.push_N = 0.0;
  EXPECT_FALSE(change(2).guidance.present);
}

// With random poses, velocities and depths in bone, under both laws: the sum of coupling and guidance must
// stay within the cell's limits of force and torque.
class GuidedPipeline : public testing::TestWithParam<Law> {};
INSTANTIATE_TEST_SUITE_P(, GuidedPipeline, testing::Values(Law::kAdmittance, Law::kImpedance),
                         [](const auto& law) {
                           return std::string(law.param == Law::kAdmittance ? "Admittance" : "Impedance");
                         });

TEST_P(GuidedPipeline, NeverRendersMoreThanTheCellsLimit) {
  ServoParams params = GuidedParams(0.0);
  params.law = GetParam();
  params.wrench.max_force_N = 60.0;
  params.wrench.max_torque_Nm = 3.0;
  const auto arm = Follower(params);
  CouplingPipeline pipeline(params);
  pipeline.Reset();
  const Pose X_start = ServoBench::StartPose();
  std::mt19937 random(39);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] { return Vector3(unit(random), unit(random), unit(random)); };
  rt::Nanoseconds now = rt::kSecond;
  double max_balance_J = 0.0, max_scale = 0.0;
  bool yielded = false;
  Vector3 p_m = Vector3::Zero(), turn = Vector3::Zero(), v = Vector3::Zero(), w = Vector3::Zero();
  for (int i = 0; i < 20000; ++i) {
    now += rt::kMillisecond;
    v = 0.98 * v + 0.012 * vector() - 0.03 * p_m;
    w = 0.98 * w + 0.06 * vector() - 0.03 * turn;
    p_m += 1e-3 * v;
    turn += 1e-3 * w;
    Pose X_WT = X_start;
    X_WT.translation() += p_m;
    X_WT.linear() = ExpRotation(turn) * X_start.linear();
    safety::LimitSet acting;
    static_cast<void>(pipeline.Evaluate({.model = PlaneBehind(4e-3 * std::max(0.0, std::sin(0.01 * i)), now),
                                         .X_WT = X_WT,
                                         .V_WT = {.v = v, .w = w},
                                         .now = now},
                                        *arm, acting));
    safety::LimitedWrench rendered = pipeline.Render(*arm, acting);
    ASSERT_LE(rendered.F.f.norm(), 60.0) << i;
    ASSERT_LE(rendered.F.t.norm(), 3.0) << i;
    if (i % 5 == 0) pipeline.LimitPower(0.7, rendered, acting);
    const Guidance& guidance = *pipeline.guidance();
    max_balance_J = std::max(
        max_balance_J, guidance.scale().energy_J() + guidance.scale().scale() * guidance.field().potential_J);
    max_scale = std::max(max_scale, guidance.scale().scale());
    yielded |= guidance.field().potential_J > 0.0 && guidance.scale().scale() < 0.01;
    if (i % 5 != 0) {
      ASSERT_EQ(acting.Has(safety::Limit::kGuidance), guidance.acts()) << i;
    }
  }
  EXPECT_LE(max_balance_J, 1e-6);
  EXPECT_EQ(max_scale, 1.0);
  EXPECT_TRUE(yielded);
}

TEST(ServoGuidance, DoesNotAllocate) {
  FreeAirBench bench(GuidedParams(1e-3));
  bench.push_N = 40.0;
  bench.side_W_N = 10.0 * ServoBench::StartPose().linear().col(0);
  ASSERT_GT(bench.Run(2000).guidance.potential_J, 0.0);
  const rt::CheckedNoAllocScope scope;
  bench.Run(20);
}

}  // namespace
}  // namespace osteon::control
