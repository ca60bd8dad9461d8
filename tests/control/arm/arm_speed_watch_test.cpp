#include "control/arm/arm_speed_watch.h"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/base/checked_no_alloc_scope.h"
#include "tests/control/loop/servo_bench.h"

// Tests the watch on the measured tool speed, which trips when the arm moves faster than commanded. The watch
// is tested alone and in the servo loop.

namespace osteon::control {
namespace {

using safety::CellState, safety::Fault;

// period of a KR, and speed limit of its shipped cell
constexpr double kPeriod_s = 0.004, kLimit_m_per_s = 0.1;
constexpr rt::Nanoseconds kPeriod = 4 * rt::kMillisecond;

// A watch, and the messages of an arm whose tool moves along x.
struct Arm {
  explicit Arm(const ArmSpeedParams& params = {}) : watch(params, kPeriod_s) { state.stamp = rt::kSecond; }
  // Receives the next message, one period later, with the tool at x_m. @returns whether the watch trips
  bool ReceiveAt(double x_m) {
    state.stamp += kPeriod;
    return watch.Check(state, {x_m, 0.2, -0.3}, kLimit_m_per_s);
  }
  ArmSpeedWatch watch;
  ArmState state;
};

TEST(ArmSpeedWatch, SpeedIsDistanceOverTimeBetweenMessages) {
  Arm arm;
  EXPECT_FALSE(arm.ReceiveAt(0.5)) << "where it begins is no way";
  EXPECT_EQ(arm.watch.speed_m_per_s(), 0.0);
  EXPECT_FALSE(arm.ReceiveAt(0.5004));
  EXPECT_NEAR(arm.watch.speed_m_per_s(), 0.1, 1e-9);
}

// If an absolute correction of RSI falls back to zero, the arm jumps back. Here the jump is 2.1 mm in 4 ms.
TEST(ArmSpeedWatch, AJumpOfTwoMillimetresInAMessageTrips) {
  Arm arm;
  double x_m = 0.0;
  for (int i = 0; i < 100; ++i) ASSERT_FALSE(arm.ReceiveAt(x_m += 0.1 * kPeriod_s));
  EXPECT_TRUE(arm.ReceiveAt(x_m - 2.1e-3));
  EXPECT_NEAR(arm.watch.speed_m_per_s(), 0.525, 1e-9);
}

// A speed of up to 1.5 times the limit adds no excess distance. At twice the limit, about five messages reach
// the allowed excess distance of 1 mm.
TEST(ArmSpeedWatch, OneAndAHalfTimesTheLimitNeverTripsAndTwiceTripsSoon) {
  Arm arm;
  double x_m = 0.0;
  for (int i = 0; i < 10'000; ++i) ASSERT_FALSE(arm.ReceiveAt(x_m += 1.5 * kLimit_m_per_s * kPeriod_s));
  int messages = 0;  // each adds (2.0 - 1.5) × 0.1 m/s × 4 ms = 0.2 mm of excess
  while (!arm.ReceiveAt(x_m += 2.0 * kLimit_m_per_s * kPeriod_s)) ASSERT_LE(++messages, 6);
  EXPECT_GE(messages, 4);
}

TEST(ArmSpeedWatch, LostAndLateMessagesCountAsAPeriodEach) {
  for (const bool late : {false, true}) {
    Arm arm;
    double x_m = 0.0;
    static_cast<void>(arm.ReceiveAt(x_m));
    for (int i = 0; i < 500; ++i) {
      const std::uint32_t missing = i % 7 == 3 ? 5 : 0;
      (late ? arm.state.late : arm.state.lost) += missing;
      // all messages have the same arrival time, so only the count of messages tells how much time has passed
      ASSERT_FALSE(arm.ReceiveAt(x_m += (1 + missing) * kLimit_m_per_s * kPeriod_s)) << i;
      ASSERT_NEAR(arm.watch.speed_m_per_s(), kLimit_m_per_s, 1e-9);
    }
  }
}

TEST(ArmSpeedWatch, JitterOfArrivalDoesNotRaiseTheSpeed) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> late_s(0.0, 0.9 * kPeriod_s);
  Arm arm;
  const rt::Nanoseconds start = arm.state.stamp;
  double x_m = 0.0;
  for (int i = 1; i < 5000; ++i) {
    arm.state.stamp = start + (i - 1) * kPeriod + static_cast<rt::Nanoseconds>(1e9 * late_s(random));
    ASSERT_FALSE(arm.ReceiveAt(x_m += kLimit_m_per_s * kPeriod_s)) << i;
    ASSERT_LE(arm.watch.speed_m_per_s(), kLimit_m_per_s * (1.0 + 1e-9));
  }
}

TEST(ArmSpeedWatch, AClockThatJumpsDoesNotAllowALongDistance) {
  Arm arm;
  static_cast<void>(arm.ReceiveAt(0.0));
  arm.state.stamp += 3600 * rt::kSecond;
  EXPECT_TRUE(arm.ReceiveAt(0.05)) << "5 cm";
  arm.watch.Reset();
  static_cast<void>(arm.ReceiveAt(0.0));
  arm.state.stamp -= 3600 * rt::kSecond;
  EXPECT_FALSE(arm.ReceiveAt(kLimit_m_per_s * kPeriod_s)) << "back: a period";
}

TEST(ArmSpeedWatch, AResetForgetsWhereTheArmWas) {
  Arm arm;
  static_cast<void>(arm.ReceiveAt(0.0));
  arm.watch.Reset();
  EXPECT_FALSE(arm.ReceiveAt(1.0));
  EXPECT_EQ(arm.watch.speed_m_per_s(), 0.0);
}

TEST(ArmSpeedWatch, RefusesParametersByName) {
  EXPECT_THROW(ArmSpeedWatch({.margin = 0.9}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ArmSpeedWatch({.excess_m = 0.0}, 1e-3), std::invalid_argument);
  EXPECT_THROW(ArmSpeedWatch({}, std::nan("")), std::invalid_argument);
}

TEST(ArmSpeedWatch, DoesNotAllocate) {
  Arm arm;
  {
    rt::CheckedNoAllocScope scope;
    for (int i = 0; i < 100; ++i) static_cast<void>(arm.ReceiveAt(1e-4 * i));
  }
}

// A hand pushes the tool until it moves at its speed limit.
TEST(ArmSpeedInTheLoop, MotionAtTheSpeedLimitIsReportedAndDoesNotTrip) {
  ServoBench bench(ServoBench::Params(), 1.0);
  bench.Activate();
  bench.push_N = 100.0;
  TickRecord record;
  double most_m_per_s = 0.0;
  for (int i = 0; i < 400; ++i) {
    record = bench.Tick();
    most_m_per_s = std::max(most_m_per_s, record.tool_speed_meas_m_per_s);
  }
  EXPECT_FALSE(bench.loop.faults().Has(Fault::kArmSpeed));
  const ServoStatistics& seen = bench.loop.statistics();
  EXPECT_NEAR(seen.peak_measured_tool_speed_m_per_s, seen.peak_tool_speed_m_per_s, 1e-6);
  EXPECT_EQ(most_m_per_s, seen.peak_measured_tool_speed_m_per_s);
}

// The arm jumps once in each state in which the loop commands the arm.
TEST(ArmSpeedInTheLoop, AnArmThatJumpsStopsTheCellInEveryState) {
  enum class State { kRendering, kStop, kPause, kPaused };
  for (const State state : {State::kRendering, State::kStop, State::kPause, State::kPaused}) {
    SCOPED_TRACE(static_cast<int>(state));
    ServoBench bench(ServoBench::Params(), 1.0);  // no bone is near, so a stop takes its full time
    bench.Activate();
    bench.push_N = 40.0;
    bench.Run(200);
    ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
    if (state == State::kStop) bench.loop.RequestStop();
    if (state == State::kPause || state == State::kPaused) bench.loop.RequestPause();
    if (state != State::kRendering) bench.Run(state == State::kPaused ? 200 : 1);
    ASSERT_FALSE(bench.loop.faults().Any());
    ArmState thrown = bench.arm;
    thrown.q_meas = bench.command.q;
    thrown.q_meas[0] += 4e-3;  // about 2 mm at the apex within 1 ms, thus 2 m/s
    thrown.stamp = bench.now += ServoBench::kTick;
    ++thrown.sequence;
    bench.readings.force.stamp = bench.now;
    const TickRecord record = bench.loop.Tick({.state = thrown,
                                               .received = ReceiveResult::kOk,
                                               .readings = bench.readings,
                                               .model = bench.model,
                                               .now = bench.now},
                                              bench.command);
    EXPECT_EQ(record.faults, static_cast<std::uint32_t>(Fault::kArmSpeed));
    EXPECT_GT(record.tool_speed_meas_m_per_s, 1.0);
    EXPECT_FALSE(safety::IsMotion(bench.loop.state()));
    bench.arm_moves = false;
    bench.Run(200);
    EXPECT_EQ(bench.loop.state(), CellState::kFault);
  }
}

TEST(ArmSpeedInTheLoop, AnArmThatItsOwnProgramMovesIsNotWatched) {
  ServoBench bench;
  bench.Run(20);
  bench.arm_moves = false;
  for (int i = 0; i < 50; ++i) {  // the arm is jogged by its own program
    bench.arm.q_meas[0] += 2e-3;
    bench.Tick();
  }
  EXPECT_FALSE(bench.loop.faults().Any());
  EXPECT_EQ(bench.loop.statistics().peak_measured_tool_speed_m_per_s, 0.0);
}

}  // namespace
}  // namespace osteon::control
