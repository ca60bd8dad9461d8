// Tests how the loop treats inputs that are missing or late, or whose time stamp lies in the future or far in
// the past.

#include <limits>

#include <gtest/gtest.h>

#include "servo_bench.h"

namespace osteon::control {
namespace {

using safety::Fault;

// The simulation assumes that the first pose it gets is free of bone. So this pose must be the tool's pose,
// and not the origin of the world.
TEST(ServoInput, TheSimulationGetsNoPoseBeforeTheArmReportsOne) {
  ServoBench bench;
  for (int i = 0; i < 10; ++i) bench.Tick(ReceiveResult::kTimeout);
  EXPECT_EQ(bench.loop.tool_command().stamp, 0) << "no message yet";
  const JointArray q = bench.arm.q_meas;
  bench.arm.session = SessionState::kIdle;
  bench.arm.q_meas = {};  // an idle arm need not report its joint positions
  bench.arm.has_ipo = false;
  bench.Tick();
  EXPECT_EQ(bench.loop.tool_command().stamp, 0) << "idle";
  bench.arm.session = SessionState::kMonitoringReady;
  bench.arm.q_meas = q;
  const TickRecord record = bench.loop.Tick(
      {.state = bench.arm, .received = ReceiveResult::kOk, .readings = {}, .model = {}, .now = bench.now},
      bench.command);
  EXPECT_EQ(bench.loop.tool_command().stamp, bench.now);
  EXPECT_LT((Pose(record.X_WT_cmd).matrix() - ServoBench::StartPose().matrix()).norm(), 1e-9);
}

// A frame contains only planes within 0.25 mm of the tool (CuttingParams). A plane that is farther away
// appears in a later frame, when the tool may already be inside the bone. The sudden change of force must
// then stay below the trip on the wrench's rate.
TEST(ServoInput, BoneThatAppearsBetweenFramesCausesNoFault) {
  for (const bool one_frame_behind : {false, true})
    for (const int frame_ticks : {1, 2, 3, 5, 8}) {
      // distances in steps of 0.1 mm, so that the first contact occurs at different times within a frame
      for (double ahead_m = 0.020; ahead_m < 0.0221; ahead_m += 0.0001) {
        ServoBench bench(ServoBench::Params(), ahead_m);
        bench.reach_m = simulation::CuttingParams{}.normal_enlargement_m;
        bench.frame_ticks = frame_ticks;
        bench.one_frame_behind = one_frame_behind;
        bench.push_N = 40.0;
        bench.Activate();
        for (int i = 0; i < 2500 && bench.Depth() < 1e-3; ++i) {
          const TickRecord record = bench.Tick();
          ASSERT_EQ(record.faults, 0u) << "frame of " << frame_ticks << " ms, depth " << bench.Depth() * 1e3
                                       << " mm, model of " << record.model_age_s * 1e3 << " ms";
        }
        EXPECT_GE(bench.Depth(), 1e-3) << "it was reached";
      }
    }
}

// The loop multiplies speeds by the cell's period. An arm that sends five times as many messages would move
// five times as fast.
TEST(ServoInput, AnArmWhosePeriodDiffersFromTheCellsIsNotMoved) {
  for (const double period_s : {0.001, 0.010, 0.0, std::numeric_limits<double>::quiet_NaN()}) {
    ServoParams params = ServoBench::Params();
    params.period_s = 0.005;
    ServoBench bench(params, 10.0);
    bench.arm.period_s = period_s;
    bench.push_N = 40.0;
    bench.Activate();
    const TickRecord record = bench.Run(100);
    EXPECT_EQ(record.phase, Phase::kStopped);
    EXPECT_EQ(record.faults, static_cast<std::uint32_t>(Fault::kPeriod));
    EXPECT_LT((Pose(record.X_WT_cmd).translation() - ServoBench::StartPose().translation()).norm(), 1e-9);
  }
}

// The records' time stamps must continue while the arm is silent, and must begin when the loop begins.
TEST(ServoInput, ATickWithoutAMessageIsRecordedAtItsOwnTime) {
  ServoBench bench;
  EXPECT_EQ(bench.Tick(ReceiveResult::kTimeout).stamp, bench.now) << "before the first message";
  EXPECT_EQ(bench.Tick().stamp, bench.arm.stamp);
  EXPECT_EQ(bench.Tick(ReceiveResult::kTimeout).stamp, bench.now) << "not the stamp of the message before";
}

// The time stamps are ahead of the loop's clock or behind it, by up to half of the largest representable
// time.
TEST(ServoInput, AModelOrReadingWithAWrongStampIsNotFresh) {
  for (const rt::Nanoseconds offset :
       {2 * rt::kMillisecond, 70 * rt::kMillisecond, 3600 * rt::kSecond, -80 * rt::kMillisecond,
        -3600 * rt::kSecond, std::numeric_limits<rt::Nanoseconds>::max() / 2,
        std::numeric_limits<rt::Nanoseconds>::min() / 2}) {
    ServoBench bench;
    bench.Activate();
    bench.push_N = 120.0;
    bench.Run(2000);
    ASSERT_GT(bench.loop.statistics().peak_coupling_force_N, 100.0);
    bench.simulation_lives = false;
    simulation::ContactModel model = bench.model;
    model.pose_stamp = bench.now + offset;
    model.frame += 1000;
    TickRecord record = bench.loop.Tick({.state = bench.arm,
                                         .received = ReceiveResult::kOk,
                                         .readings = bench.readings,
                                         .model = model,
                                         .now = bench.now},
                                        bench.command);
    EXPECT_EQ(Vector3(record.F_coupling_T_W.f).norm(), 0.0) << "offset " << offset;

    ServoBench other(ServoBench::Params(), 1.0);
    other.Activate();
    other.Run(200);
    CellReadings readings = other.readings;
    readings.force.stamp = other.now + offset;
    readings.force.F_S =
        ServoBench::OnTheSensor({.f = Vector3(0.0, 0.0, 200.0), .t = Vector3::Zero()}, other.ToolNow());
    // a reading of this age still counts: its force fades to 0 at an age of 100 ms
    if (offset == -80 * rt::kMillisecond) continue;
    record = other.loop.Tick({.state = other.arm,
                              .received = ReceiveResult::kOk,
                              .readings = readings,
                              .model = other.model,
                              .now = other.now},
                             other.command);
    EXPECT_TRUE(other.loop.faults().Has(Fault::kSensorStale)) << "offset " << offset;
    EXPECT_EQ(Vector3(record.v_WT_cmd_m_per_s).norm(), 0.0) << "not moved by it";
  }
}

// Every third frame is old (45 ms), the others are new. The loop must use each frame at its own age: with an
// old frame the force falls at once, and afterwards it rises only slowly.
TEST(ServoInput, AnOlderFrameAfterANewerOneIsUsedAtItsAge) {
  ServoBench bench;
  bench.Activate();
  bench.push_N = 120.0;
  bench.Run(2000);
  bench.simulation_lives = false;
  const simulation::ContactModel newest = bench.model;
  double before_N = 120.0;
  for (int i = 0; i < 200; ++i) {
    bench.now += ServoBench::kTick;
    bench.readings.force.stamp = bench.now;
    simulation::ContactModel model = newest;
    const bool old = i % 3 == 0;
    model.frame = newest.frame + 100 + static_cast<std::uint64_t>(i) - (old ? 50 : 0);
    model.pose_stamp = bench.now - (old ? 45 : 1) * rt::kMillisecond;
    const TickRecord record = bench.loop.Tick({.state = bench.arm,
                                               .received = ReceiveResult::kOk,
                                               .readings = bench.readings,
                                               .model = model,
                                               .now = bench.now},
                                              bench.command);
    ASSERT_EQ(record.faults, 0u) << "tick " << i;
    const double f_N = Vector3(record.F_coupling_T_W.f).norm();
    ASSERT_LE(f_N, std::max(0.4 * 120.0, before_N) + 2.5) << "falls with the age at once, comes back slowly";
    before_N = f_N;
    bench.arm.q_meas = bench.command.q;
  }
}

// The clock is set back or forward. The force must not rise abruptly, and no tick may move the tool farther
// than a tick allows.
TEST(ServoInput, AJumpOfTheClockDoesNotRaiseTheForceAbruptly) {
  for (const rt::Nanoseconds jump : {-10 * rt::kSecond, -2 * rt::kMillisecond, 10 * rt::kSecond}) {
    ServoBench bench;
    bench.Activate();
    bench.push_N = 120.0;
    double before_N = 0.0;
    for (int i = 0; i < 1000; ++i) {
      if (i == 800) bench.now += jump;
      const Vector3 p = Pose(bench.loop.tool_command().X_WT).translation();
      const TickRecord record = bench.Tick();
      const double f_N = Vector3(record.F_coupling_T_W.f).norm();
      if (i == 799) {
        ASSERT_GT(f_N, 50.0) << "pressed with 120 N: there is a force that could jump";
      }
      if (i >= 800) {
        ASSERT_LE(f_N, before_N + 7.5) << "tick " << i << " jump " << jump;
        ASSERT_LE((Pose(record.X_WT_cmd).translation() - p).norm(), 0.25e-3 * 1.01);
      }
      before_N = f_N;
    }
  }
}

}  // namespace
}  // namespace osteon::control
