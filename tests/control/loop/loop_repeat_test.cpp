#include "control/loop/loop_repeat.h"

#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "servo_bench.h"
#include "tests/base/checked_no_alloc_scope.h"

// Tests LoopRepeat: a second loop computes each tick again from the tick's record, and every bit of the
// results must be equal.

namespace osteon::control {
namespace {

// A loop with the bench's arm and these parameters.
ServoLoop Loop(const ServoParams& params) {
  return {params, ServoBench::Arm(), Pose::Identity(), ServoBench::FlangeToTool(),
          ServoBench::Arm().ArmAngle(ServoBench::StartJoints())};
}

// Applies the events of this tick to the bench: a hand, a silent sensor, new gains, a pause, an arm that
// leaves and returns, or a stop.
void ApplyEvents(ServoBench& bench, int tick) {
  bench.push_N = 60.0 * std::sin(0.01 * tick);
  bench.sensor_lives = tick < 700 || tick > 712;
  if (tick == 10) bench.Activate();
  if (tick == 400) {
    Gains gains = GainsOf(ServoBench::Params().admittance, ServoBench::Params().coupling);
    gains.max_stiffness_N_per_m = 9e3;
    bench.loop.RequestGains(gains);
  }
  if (tick == 1000) bench.loop.RequestPause();
  if (tick == 1300) bench.loop.RequestResume();
  if (tick == 1600) bench.arm.session = SessionState::kMonitoringReady;
  if (tick == 1650) {
    bench.Activate();
    ++bench.arm.activation;
  }
  if (tick == 1700) bench.loop.RequestRecovery();
  if (tick == 2300) bench.loop.RequestStop();
}

TEST(LoopRepeat, AWholeRunWithAllEventsIsRepeatedIdentically) {
  ServoBench bench;
  ServoLoop second = Loop(ServoBench::Params());
  LoopRepeat repeat(second);
  bool rendered_again = false;
  for (int tick = 0; tick < 2600; ++tick) {
    ApplyEvents(bench, tick);
    const bool lost = tick % 97 == 0 || (tick > 500 && tick < 504);
    const TickRecord record = bench.Tick(lost ? ReceiveResult::kTimeout : ReceiveResult::kOk);
    EXPECT_FALSE(repeat.due());
    repeat.StoreTick(record, bench.model);
    ASSERT_TRUE(repeat.due());
    ASSERT_TRUE(repeat.ReplayStoredTick()) << tick;
    rendered_again |= tick > 1700 && record.phase == Phase::kHaptic;
  }
  EXPECT_TRUE(rendered_again) << "the recovery was part of it";
  EXPECT_EQ(second.phase(), bench.loop.phase());
  EXPECT_EQ(second.faults().bits(), bench.loop.faults().bits());
}

// In each case, the last bit of one recorded result of tick 250 is changed. LoopRepeat must report exactly
// this tick.
TEST(LoopRepeat, ADifferenceInTheLastBitOfAnyResultIsFound) {
  const auto flip = [](double& value) {
    value = std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) ^ 1u);
  };
  const std::array<std::function<void(TickRecord&)>, 9> damages{
      [&](TickRecord& r) { flip(r.q_cmd[6]); },     [&](TickRecord& r) { flip(r.tau_cmd[0]); },
      [&](TickRecord& r) { flip(r.F_cmd_T.f.x); },  [&](TickRecord& r) { flip(r.F_coupling_T_W.t.z); },
      [&](TickRecord& r) { flip(r.X_WT_cmd.p.y); }, [&](TickRecord& r) { flip(r.v_WT_cmd_m_per_s.x); },
      [](TickRecord& r) { r.faults ^= 1u; },        [](TickRecord& r) { r.limits ^= 1u; },
      [](TickRecord& r) { ++r.activation_cmd; }};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    ServoBench bench;
    bench.push_N = 40.0;
    bench.Activate();
    ServoLoop second = Loop(ServoBench::Params());
    LoopRepeat repeat(second);
    for (int tick = 0; tick < 300; ++tick) {
      TickRecord record = bench.Tick();
      if (tick == 250) damages[i](record);
      repeat.StoreTick(record, bench.model);
      ASSERT_EQ(repeat.ReplayStoredTick(), tick != 250) << "damage " << i << ", tick " << tick;
    }
  }
}

// The second loop has a mass that differs in the last bit. The difference can be seen only once the tool
// moves.
TEST(LoopRepeat, AParameterThatDiffersByOneBitIsFoundOnceTheToolMoves) {
  ServoParams other = ServoBench::Params();
  other.admittance.mass_kg.x() = std::nextafter(other.admittance.mass_kg.x(), 10.0);
  ServoBench bench;
  bench.push_N = 40.0;
  bench.side_W_N = {3.0, -2.0, 1.0};
  bench.Activate();
  ServoLoop second = Loop(other);
  LoopRepeat repeat(second);
  int seen_at = -1;
  for (int tick = 0; tick < 400 && seen_at < 0; ++tick) {
    repeat.StoreTick(bench.Tick(), bench.model);
    if (!repeat.ReplayStoredTick()) seen_at = tick;
  }
  EXPECT_GE(seen_at, 1) << "nothing moves at once";
  EXPECT_LT(seen_at, 60) << "the tool moves";
}

TEST(LoopRepeat, ADifferenceStopsTheLoopAndTheStopIsRepeatedIdentically) {
  ServoBench bench(ServoBench::Params(), 0.05);
  bench.push_N = 10.0;
  bench.Activate();
  ServoLoop second = Loop(ServoBench::Params());
  LoopRepeat repeat(second);
  TickRecord record;
  int stopped_after = -1;
  double speed_m_per_s = 0.0;
  for (int tick = 0; tick < 800; ++tick) {
    if (tick == 400) {
      speed_m_per_s = Vector3(record.v_WT_cmd_m_per_s).norm();
      bench.loop.ReportDifference();
    }
    record = bench.Tick();
    EXPECT_EQ(record.input.repeat_differed, tick == 400);
    repeat.StoreTick(record, bench.model);
    ASSERT_TRUE(repeat.ReplayStoredTick()) << tick;
    if (tick >= 400) {
      ASSERT_EQ(record.faults, static_cast<std::uint32_t>(safety::Fault::kRepeatDiffers));
      if (stopped_after < 0 && record.phase == Phase::kStopped) stopped_after = tick - 400;
    }
  }
  EXPECT_GT(speed_m_per_s, 0.02);
  const double ramp_ticks = speed_m_per_s / ServoBench::Params().stop_deceleration_m_per_s2 * 1e3;
  EXPECT_GE(stopped_after, static_cast<int>(ramp_ticks) - 1) << "braked, not dropped";
  EXPECT_LE(stopped_after, static_cast<int>(2.0 * ramp_ticks) + 5);
}

TEST(LoopRepeat, DoesNotAllocate) {
  ServoBench bench;
  bench.Activate();
  ServoLoop second = Loop(ServoBench::Params());
  LoopRepeat repeat(second);
  for (int tick = 0; tick < 100; ++tick) {
    const TickRecord record = bench.Tick();
    rt::CheckedNoAllocScope no_alloc;
    repeat.StoreTick(record, bench.model);
    bench.loop.Prefetch();
    ASSERT_TRUE(repeat.ReplayStoredTick());
  }
}

}  // namespace
}  // namespace osteon::control
