#include "session/summary/latency.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "config/reading/cell_config.h"
#include "control/ports.h"
#include "hil/arm/servo_arm.h"
#include "safety/watchdog.h"
#include "session/run/live_latency.h"

// The parts of a cell's latency, computed from generated ticks with known delays.

namespace osteon::session {
namespace {

constexpr double kPeriod_s = 1e-3;

// Makes 4000 ticks of an arm that follows a slow motion of all joints, and calls `take` with each. In each
// tick the sensor's reading is 0.4 ms old and the model 2 ms; the loop wakes up after 50 us and computes for
// 20 us.
template <class Take>
void MakeTicks(const hil::ServoArmParams& params, double speed_rad_per_s, control::CommandMode mode,
               const Take& take) {
  std::array<kinematics::JointLimits, 7> limits;
  for (auto& limit : limits) limit.velocity_rad_per_s = 10.0;
  hil::ServoArm arm(params, limits, kPeriod_s, kinematics::JointVector::Zero());
  for (int k = 0; k < 4000; ++k) {
    control::TickRecord tick;
    tick.session_state = static_cast<std::uint8_t>(control::SessionState::kCommandingActive);
    tick.phase = control::Phase::kHaptic;
    tick.input.command_mode = static_cast<std::uint8_t>(mode);
    tick.sensor_age_s = 0.4e-3;
    tick.model_age_s = 2e-3;
    tick.wakeup_ns = 50'000;
    tick.compute_ns = 20'000;
    for (int j = 0; j < 7; ++j) {
      const auto at = static_cast<std::size_t>(j);
      tick.q_meas[at] = arm.q()[j];
      tick.q_cmd[at] = speed_rad_per_s / 2.0 * std::sin(2.0 * k * kPeriod_s + 0.3 * j);
    }
    take(tick);
    arm.Step(Eigen::Map<const kinematics::JointVector>(tick.q_cmd.data()));
  }
}

// A latency meter that got the ticks of an arm with these parameters.
LatencyMeter MeasureMotion(const hil::ServoArmParams& params, double speed_rad_per_s,
                           control::CommandMode mode) {
  LatencyMeter meter;
  MakeTicks(params, speed_rad_per_s, mode, [&](const control::TickRecord& tick) { meter.Add(tick); });
  return meter;
}

// Counts the ticks that are passed on.
struct CountingSink final : io::RecordSink {
  int ticks{0};
  void TakeTick(const control::TickRecord&) override { ++ticks; }
  void TakeFrame(const simulation::FrameRecord&) override {}
  void TakeEvent(const io::RecordedEvent&) override {}
};

TEST(Latency, IsKnownDuringTheRun) {
  config::CellConfig cell;
  cell.servo.period_s = kPeriod_s;
  CountingSink next;
  LiveLatency live(cell, next);
  EXPECT_FALSE(live.Status().known);
  const hil::ServoArmParams arm{.dead_cycles = 3.0};
  MakeTicks(arm, 0.2, control::CommandMode::kPosition,
            [&](const control::TickRecord& tick) { live.TakeTick(tick); });
  EXPECT_EQ(next.ticks, 4000) << "everything goes on to the view";
  const console::LatencyStatus status = live.Status();
  const LatencyFigures whole =
      MeasureMotion(arm, 0.2, control::CommandMode::kPosition).Figures(kPeriod_s, {});
  ASSERT_TRUE(status.known);
  EXPECT_FALSE(status.measured) << "the sensor's own delay is assumed";
  EXPECT_NEAR(status.hand_to_arm_ms, 1e3 * whole.hand_to_arm_s, 0.01);
  ASSERT_EQ(status.parts.size(), whole.parts.size());
  EXPECT_EQ(status.parts[3].name, "arm");
  EXPECT_NEAR(status.parts[3].mean_ms, 1e3 * whole.parts[3].mean_s, 0.01);
}

TEST(Latency, TheArmsPartIsItsDeadTimePlusItsLag) {
  for (const double dead : {0.0, 3.0, 4.6}) {
    const hil::ServoArmParams arm{.dead_cycles = dead};
    const LatencyFigures found =
        MeasureMotion(arm, 0.2, control::CommandMode::kPosition).Figures(kPeriod_s, {});
    const double lag_s = dead * kPeriod_s + 2.0 / (2.0 * std::numbers::pi * 15.0);
    ASSERT_EQ(found.parts.size(), 5u);
    EXPECT_EQ(found.parts[3].name, "arm");
    EXPECT_TRUE(found.parts[3].measured);
    // each command is held for a period, which adds half a period on average
    EXPECT_NEAR(found.parts[3].mean_s, lag_s + 0.5 * kPeriod_s, 0.1e-3) << dead;
  }
}

TEST(Latency, TheTotalIsTheSumOfItsPartsAndNamesAssumedOnes) {
  const LatencyMeter meter = MeasureMotion({}, 0.2, control::CommandMode::kPosition);
  const LatencyFigures wall = meter.Figures(kPeriod_s, {.sensor_delay_s = 1.7e-3, .sensor_known = true});
  EXPECT_TRUE(wall.Measured());
  const double arm_s = wall.parts[3].mean_s;
  EXPECT_NEAR(wall.hand_to_arm_s, 0.4e-3 + 1.7e-3 + 50e-6 + 20e-6 + arm_s, 1e-9);
  EXPECT_NEAR(wall.bone_to_hand_s, 2e-3 + 50e-6 + 20e-6 + arm_s, 1e-9);
  EXPECT_EQ(LatencyText(wall).find("assumed"), std::string::npos);

  const LatencyFigures virtual_time = meter.Figures(kPeriod_s, {.virtual_time = true});
  EXPECT_FALSE(virtual_time.Measured());
  EXPECT_EQ(virtual_time.parts[1].mean_s, 0.0);
  EXPECT_NE(LatencyText(virtual_time).find("assumed: sensor"), std::string::npos)
      << LatencyText(virtual_time);
  const nlohmann::json json = ToJson(virtual_time);
  EXPECT_EQ(json.at("measured"), false);
  EXPECT_EQ(json.at("parts").at("arm").at("measured"), true);
  EXPECT_NEAR(json.at("hand_to_arm").get<double>(), 1e3 * virtual_time.hand_to_arm_s, 1e-9);
}

// On a busy machine the arm may be commanded before the sensor's first reading.
TEST(Latency, TicksBeforeTheFirstReadingDoNotCount) {
  LatencyMeter meter;
  int ticks = 0;
  MakeTicks({}, 0.2, control::CommandMode::kPosition, [&](control::TickRecord tick) {
    if (++ticks <= 130) tick.sensor_age_s = tick.model_age_s = safety::kNoAge_s;
    meter.Add(tick);
  });
  const LatencyFigures figures = meter.Figures(kPeriod_s, {.sensor_delay_s = 1.7e-3, .sensor_known = true});
  EXPECT_NEAR(figures.parts[0].mean_s, 0.4e-3 + 1.7e-3, 1e-9) << "not hours";
  EXPECT_NEAR(figures.bone_to_hand_s, 2e-3 + 50e-6 + 20e-6 + figures.parts[3].mean_s, 1e-9);
  LatencyMeter never;
  MakeTicks({}, 0.2, control::CommandMode::kPosition, [&](control::TickRecord tick) {
    tick.sensor_age_s = safety::kNoAge_s;
    never.Add(tick);
  });
  EXPECT_NE(LatencyText(never.Figures(kPeriod_s, {.sensor_known = true})).find("no reading came"),
            std::string::npos);
}

TEST(Latency, UnderTheImpedanceLawTheArmsPartIsTheDeadTimeOfForces) {
  config::CellConfig cell;
  cell.servo.law = control::Law::kImpedance;
  cell.simulated.dynamic.dead_cycles = 3;
  cell.servo.period_s = kPeriod_s;
  const LatencyMeter meter = MeasureMotion({}, 0.2, control::CommandMode::kWrench);
  const LatencyFigures assumed = meter.Figures(kPeriod_s, LatencyContextOf(cell, false));
  EXPECT_TRUE(assumed.hand_moves_arm);
  EXPECT_EQ(assumed.parts[3].mean_s, 3e-3);
  EXPECT_FALSE(assumed.parts[3].measured);
  EXPECT_NEAR(assumed.bone_to_hand_s, 2e-3 + 50e-6 + 20e-6 + 3e-3, 1e-9);
  EXPECT_TRUE(ToJson(assumed).at("hand_to_arm").is_null());
  EXPECT_EQ(LatencyText(assumed).rfind("the hand moves the arm itself, 5.1 ms from the bone", 0), 0u)
      << LatencyText(assumed);
  cell.identified.emplace();
  cell.identified->arm = {{.axis = "x", .dead_time_s = 3.1e-3}, {.axis = "z", .dead_time_s = 2.9e-3}};
  const LatencyFigures found = meter.Figures(kPeriod_s, LatencyContextOf(cell, false));
  EXPECT_EQ(found.parts[3].mean_s, 3.1e-3) << "the longest";
  EXPECT_TRUE(found.parts[3].measured);
}

TEST(Latency, TheDelayOfAnArmAtRestOrUnderForcesIsNotMeasured) {
  EXPECT_FALSE(
      MeasureMotion({}, 0.0, control::CommandMode::kPosition).Figures(kPeriod_s, {}).parts[3].measured);
  EXPECT_FALSE(
      MeasureMotion({}, 0.2, control::CommandMode::kWrench).Figures(kPeriod_s, {}).parts[3].measured);
  EXPECT_TRUE(LatencyMeter().Figures(kPeriod_s, {}).parts.empty());
  EXPECT_TRUE(ToJson(LatencyMeter().Figures(kPeriod_s, {})).is_null());
}

}  // namespace
}  // namespace osteon::session
