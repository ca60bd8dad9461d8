#include <gtest/gtest.h>

#include "servo_bench.h"

// Tests how the loop depends on force sensor, spindle drive and PLC: which of them it waits for, and which of
// their faults stop it.

namespace osteon::control {
namespace {

using safety::Fault;

// A cell with a drive and a PLC. Unless a test changes that, both are in order and permit motion.
class ServoDevices : public ::testing::Test {
 protected:
  static ServoParams Params() {
    ServoParams params = ServoBench::Params();
    params.has_spindle = params.has_interlock = true;
    params.spindle_rad_per_s = 26.0;
    return params;
  }

  // Runs one tick. Each device that is alive has a fresh reading.
  TickRecord Tick() {
    const rt::Nanoseconds now = bench.now + ServoBench::kTick;
    if (spindle_lives) spindle.stamp = now;
    if (interlock_lives) interlock.stamp = now;
    bench.readings.spindle = spindle;
    bench.readings.interlock = interlock;
    return bench.Tick();
  }
  TickRecord Run(int count) {
    TickRecord record;
    for (int i = 0; i < count; ++i) record = Tick();
    return record;
  }
  // Starts rendering with a hand that pushes the tool into the plane.
  void Render() {
    bench.Activate();
    bench.push_N = 60.0;
    Run(600);
    ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  }
  // Expects that this fault stops the cell: the tool is at rest within 200 ms, and the spindle is off.
  void ExpectStop(Fault fault) {
    Tick();
    EXPECT_NE(bench.loop.phase(), Phase::kHaptic);
    EXPECT_TRUE(bench.loop.faults().Has(fault));
    Run(200);
    EXPECT_EQ(bench.loop.phase(), Phase::kStopped);
    EXPECT_FALSE(bench.loop.cell_commands().motion_requested);
    EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 0.0);
    EXPECT_TRUE(bench.loop.cell_commands().quick_stop);
  }

  ServoBench bench{Params()};
  SpindleReading spindle{.speed_rad_per_s = 25.0, .ready = true};
  InterlockReading interlock{.permitted = true, .enabled = true, .spindle_permitted = true};
  bool spindle_lives{true}, interlock_lives{true};
};

TEST_F(ServoDevices, NothingMovesBeforeAllDevicesAreReady) {
  bench.Activate();
  bench.push_N = 60.0;
  const auto waits = [&](const char* why) {
    Run(50);
    EXPECT_EQ(bench.loop.phase(), Phase::kWaiting) << why;
    EXPECT_EQ(bench.command.q, bench.arm.q_ipo) << why;
    EXPECT_FALSE(bench.loop.faults().Any()) << why;
    EXPECT_TRUE(bench.loop.cell_commands().motion_requested) << why;
    EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 0.0) << why;
  };
  interlock.permitted = false;
  waits("motion is not permitted");
  interlock.permitted = true;
  interlock.enabled = false;
  waits("the enabling switch is not held, whatever the PLC permits");
  interlock.enabled = true;
  spindle.ready = false;
  waits("the drive is not configured");
  spindle.ready = true;
  spindle.fault = true;
  waits("the drive has a fault");
  spindle.fault = false;
  bench.sensor_lives = false;
  bench.readings.force.stamp = 0;
  waits("no force sensor");
  bench.sensor_lives = true;
  Tick();
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
}

TEST_F(ServoDevices, APermissionOfASilentPlcDoesNotCount) {
  Run(1);
  interlock_lives = false;
  Run(150);
  bench.Activate();
  Run(50);
  EXPECT_EQ(bench.loop.phase(), Phase::kWaiting);
}

// The command clear_faults lets the drive reset its faults. The loop may set it before the first motion and
// during a recovery, and at no other time.
TEST_F(ServoDevices, TheDrivesFaultsAreClearedOnlyBeforeTheFirstMotionAndInARecovery) {
  EXPECT_TRUE(bench.loop.cell_commands().clear_faults);
  spindle.fault = true;
  bench.Activate();
  Run(50);
  EXPECT_TRUE(bench.loop.cell_commands().clear_faults) << "checking";
  spindle.fault = false;
  Render();
  EXPECT_FALSE(bench.loop.cell_commands().clear_faults) << "rendering";
  bench.loop.RequestPause();
  Run(200);
  ASSERT_EQ(bench.loop.state(), safety::CellState::kPaused);
  EXPECT_FALSE(bench.loop.cell_commands().clear_faults) << "paused";
  spindle.fault = true;
  bench.loop.RequestResume();
  Run(20);
  ASSERT_EQ(bench.loop.state(), safety::CellState::kChecking);
  EXPECT_FALSE(bench.loop.cell_commands().clear_faults) << "it waits again, but it has moved";
  spindle.fault = false;
  Run(20);
  ASSERT_EQ(bench.loop.phase(), Phase::kHaptic);
  bench.arm.session = SessionState::kCommandingWait;
  Run(30);
  ASSERT_TRUE(bench.loop.CanRecover());
  EXPECT_FALSE(bench.loop.cell_commands().clear_faults) << "stopped";
  interlock.permitted = false;
  bench.loop.RequestRecovery();
  Run(5);
  ASSERT_EQ(bench.loop.state(), safety::CellState::kRecovery);
  EXPECT_TRUE(bench.loop.cell_commands().clear_faults);
}

TEST_F(ServoDevices, AWithdrawnPermissionStopsTheMotion) {
  Render();
  interlock.permitted = false;
  ExpectStop(Fault::kInterlock);
}

TEST_F(ServoDevices, AReleasedEnablingSwitchStopsTheMotion) {
  Render();
  interlock.enabled = false;
  ExpectStop(Fault::kInterlock);
}

TEST_F(ServoDevices, APlcSilentFor100MillisecondsStopsTheMotion) {
  Render();
  interlock_lives = false;
  Run(99);
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  Run(1);
  ExpectStop(Fault::kInterlock);
}

TEST_F(ServoDevices, AFaultOfTheDriveStopsTheMotion) {
  Render();
  spindle.fault = true;
  ExpectStop(Fault::kSpindle);
}

TEST_F(ServoDevices, ADriveSilentFor100MillisecondsStopsTheMotion) {
  Render();
  spindle_lives = false;
  Run(100);
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
  ExpectStop(Fault::kSpindle);
}

TEST_F(ServoDevices, AnUntrustedSensorReadingStopsTheMotionAndIsDiscarded) {
  Render();
  CellReadings readings = bench.readings;
  readings.force.trusted = false;
  bench.now += ServoBench::kTick;
  readings.force.stamp = readings.spindle.stamp = readings.interlock.stamp = bench.now;
  const TickRecord record = bench.loop.Tick({.state = bench.arm,
                                             .received = ReceiveResult::kOk,
                                             .readings = readings,
                                             .model = bench.model,
                                             .now = bench.now},
                                            bench.command);
  EXPECT_TRUE(bench.loop.faults().Has(Fault::kSensorFault));
  EXPECT_EQ(Vector3(record.F_operator_T_W.f).norm(), 0.0);
  EXPECT_NE(record.phase, Phase::kHaptic);
}

TEST_F(ServoDevices, TheSimulationGetsTheMeasuredSpindleSpeed) {
  Render();
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 26.0);
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 25.0) << "as measured";
  spindle.speed_rad_per_s = 1.0;
  Tick();
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 0.0) << "below a twentieth it stands still";
  spindle.speed_rad_per_s = -25.0;
  Tick();
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 0.0) << "backwards nothing is cut";
  spindle.speed_rad_per_s = 25.0;
  interlock.spindle_permitted = false;
  Tick();
  EXPECT_EQ(bench.loop.cell_commands().spindle_rad_per_s, 0.0) << "the pedal was let go";
  EXPECT_EQ(bench.loop.tool_command().spindle_rad_per_s, 25.0) << "it still turns";
  EXPECT_EQ(bench.loop.phase(), Phase::kHaptic);
}

}  // namespace
}  // namespace osteon::control
