#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "hil/can/drive_device.h"
#include "hil/can/robotous_device.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"
#include "tests/base/checked_no_alloc_scope.h"
#include "tests/hil/can/virtual_can.h"
#include "tests/io/can/can_frames.h"

// Tests the client of the spindle drive with the simulated drive on a virtual CAN bus, and the physics of the
// simulated drive.

namespace osteon::hil {
namespace {

using io::DriveGoal;
using io::DrivePhase;
using io::DriveState;
using io::test::kMs;

io::ReamerDriveParams Params() {
  return {.node = 16, .gear_ratio = 20.0, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = 40.0};
}

// The client and the simulated drive on one bus. Time advances in steps of a millisecond.
struct DriveOnBus {
  explicit DriveOnBus(const io::ReamerDriveParams& params = Params(),
                      const DriveDeviceParams& device_params = {})
      : device(device_params), drive(*io::ReamerDrive::Make(params)) {
    bus.Add(drive);
    bus.Add(device);
  }
  void Run(int milliseconds) {
    for (int i = 0; i < milliseconds; ++i) bus.Step(now += kMs);
  }
  // Runs until the client has configured the drive, at most 5 s.
  void Start() {
    for (int i = 0; i < 5000 && drive.phase() == DrivePhase::kStarting; ++i) Run(1);
  }
  // Commands a speed of the tool [rad/s] and runs for a second.
  void TurnForASecond(double speed) {
    drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = speed});
    Run(1000);
  }
  [[nodiscard]] const io::DriveStatus& status() const { return drive.status(); }

  DriveDevice device;
  io::ReamerDrive drive;
  VirtualCan bus;
  rt::Nanoseconds now{0};
};

// Resolution of the drive's messages, converted to the tool: one rpm of the motor [rad/s]; below, one per
// mille of the motor's torque [N·m].
constexpr double kSpeedStep = 2 * std::numbers::pi / 60 / 20;
constexpr double kTorqueStep = 0.001 * 0.5 * 20;

TEST(Drive, StartsTurnsAndReportsItsSpeed) {
  DriveOnBus cell;
  cell.Start();
  ASSERT_EQ(cell.drive.phase(), DrivePhase::kReady) << cell.drive.failure();
  for (const double speed : {26.18, -10.0, 0.0}) {
    cell.TurnForASecond(speed);
    EXPECT_EQ(cell.status().state, DriveState::kEnabled);
    EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), speed, kSpeedStep);
    EXPECT_NEAR(cell.status().speed_rad_per_s, speed, kSpeedStep);
  }
  EXPECT_EQ(cell.status().faults, 0u);
  EXPECT_EQ(cell.status().statusword, 0x0637) << "enabled, target reached";
  EXPECT_EQ(cell.status().temperature, 250.0);
  EXPECT_GT(cell.status().stamp, cell.now - 5 * kMs);
}

TEST(Drive, AtSteadySpeedReportsTheCuttingTorque) {
  DriveOnBus cell;
  cell.Start();
  for (const double torque : {0.0, 1.0, 4.0, 9.5}) {
    for (const double speed : {26.0, -26.0}) {
      cell.device.SetCuttingTorque(torque);
      cell.TurnForASecond(speed);
      EXPECT_NEAR(cell.status().torque_Nm, std::copysign(torque, speed), kTorqueStep) << "against the cut";
      EXPECT_NEAR(cell.status().speed_rad_per_s, speed, kSpeedStep);
    }
  }
}

TEST(Drive, ReportedTorqueAndSpeedGiveThePowerOfTheCut) {
  DriveOnBus cell;
  cell.Start();
  cell.device.SetCuttingTorque(5.0);
  cell.TurnForASecond(20.0);
  double work = 0;
  for (int i = 0; i < 1000; ++i) {
    cell.Run(1);
    work += cell.status().torque_Nm * cell.status().speed_rad_per_s * 1e-3;
  }
  EXPECT_NEAR(work, 5.0 * 20.0, 0.01 * 100.0);
}

TEST(Drive, AcceleratesAtTheConfiguredRate) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(0.0);
  cell.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 30});
  cell.Run(4);  // 4 ms, one cycle of the drive's messages
  const double start = cell.device.tool_speed_rad_per_s();
  cell.Run(100);
  // expected are 100 rad/s² for 0.1 s. The tolerance is the lag of the drive's speed loop behind the ramp, at
  // most 2/w with the angular frequency w of 20 Hz
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s() - start, 10.0, 100.0 * 2 / (2 * std::numbers::pi * 20));
}

TEST(Drive, QuickStopBrakesAlongItsRampAndStays) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(20.0);
  cell.drive.Command({.goal = DriveGoal::kQuickStop});
  cell.Run(8);
  EXPECT_EQ(cell.status().state, DriveState::kQuickStop);
  const double before = cell.device.tool_speed_rad_per_s();
  cell.Run(20);
  EXPECT_NEAR(before - cell.device.tool_speed_rad_per_s(), 400 * 0.020, 2.5) << "400 rad/s²";
  cell.Run(200);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 0.0, 0.05);
  EXPECT_EQ(cell.status().state, DriveState::kQuickStop);
  EXPECT_EQ(cell.status().statusword, 0x0617) << "the stop is finished";
  // the drive must first pass through the state off before it can be enabled again
  cell.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 20});
  cell.Run(4);
  EXPECT_NE(cell.status().state, DriveState::kEnabled);
  cell.Run(1000);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 20.0, 0.1) << "a new command may start it";
  EXPECT_EQ(cell.status().faults, 0u);
}

TEST(Drive, AStalledToolCausesAFaultAndTheTorqueLimitIsReported) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(26.0);
  cell.device.SetCuttingTorque(40.0);  // 2 N·m at the motor, above its limit of 1.5 N·m
  cell.Run(150);
  EXPECT_NEAR(cell.status().torque_Nm, 3.0 * 0.5 * 20, kTorqueStep) << "while it tries";
  cell.Run(400);
  EXPECT_EQ(cell.status().emergency_code, 0x7121);
  EXPECT_EQ(cell.status().error_code, 0x7121);
  EXPECT_EQ(cell.status().state, DriveState::kFault);
  EXPECT_EQ(cell.status().faults, io::kDriveEmergency | io::kDriveInFault);
  // With the torque removed and the fault reset, the drive must wait for a new command.
  cell.device.SetCuttingTorque(0.0);
  cell.drive.Command({.goal = DriveGoal::kOff});
  cell.Run(10);
  ASSERT_TRUE(cell.drive.ResetFaults());
  cell.Run(100);
  EXPECT_EQ(cell.status().state, DriveState::kDisabled);
  EXPECT_EQ(cell.status().faults, 0u);
  EXPECT_EQ(cell.device.tool_speed_rad_per_s(), 0.0);
  cell.TurnForASecond(10.0);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 10.0, 0.1);
}

TEST(Drive, BrakesBeforeItEntersTheFaultState) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(30.0);
  cell.device.InjectFault(0x4310);
  cell.Run(8);
  EXPECT_EQ(cell.status().state, DriveState::kFaultReaction);
  cell.Run(300);
  EXPECT_EQ(cell.status().state, DriveState::kFault);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 0.0, 0.05);
}

TEST(Drive, StopsWhenTheControllerFallsSilent) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(30.0);
  cell.bus.Connect(cell.drive, false);
  cell.Run(95);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 30.0, 0.1) << "two heartbeats of 50 ms may miss";
  cell.Run(200);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 0.0, 0.05);
  EXPECT_EQ(cell.device.statusword() & 0x4F, 0x08);
  EXPECT_NE(cell.status().faults & (io::kDriveHeartbeatLost | io::kDriveStatusLost), 0u) << "and we know";
  // After the drive is connected again, it must not turn by itself.
  cell.bus.Connect(cell.drive, true);
  cell.Run(1000);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 0.0, 0.05);
}

TEST(Drive, AnInterruptedSupplyIsDetectedAndTheDriveConfiguredAgain) {
  DriveOnBus cell;
  cell.Start();
  cell.TurnForASecond(30.0);
  cell.device.SetPower(false);
  cell.Run(30);
  cell.device.SetPower(true);
  cell.Run(400);
  EXPECT_NE(cell.status().faults & io::kDriveRestarted, 0u);
  cell.drive.Command({.goal = DriveGoal::kOff});
  cell.drive.Restart();
  cell.Start();
  ASSERT_EQ(cell.drive.phase(), DrivePhase::kReady) << cell.drive.failure();
  ASSERT_TRUE(cell.drive.ResetFaults());
  cell.TurnForASecond(10.0);
  EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 10.0, 0.1);
}

TEST(Drive, AnotherMotorThanConfiguredIsRefused) {
  auto params = Params();
  params.rated_torque_Nm = 0.6;
  DriveOnBus cell(params);
  cell.Start();
  EXPECT_NE(cell.drive.failure().find("its rated torque (object 6076:00) is 500 mN·m, accepted 600 mN·m"),
            std::string::npos)
      << cell.drive.failure();
  auto elsewhere = Params();
  elsewhere.node = 17;
  DriveOnBus absent(elsewhere);
  absent.Start();
  EXPECT_NE(absent.drive.failure().find("no answer about object 1000:00"), std::string::npos);
}

TEST(Drive, TurnsOnInSpiteOfLostDuplicatedAndReorderedFrames) {
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    DriveOnBus cell;
    cell.Start();
    cell.bus.SetParams({.loss = 0.1, .duplicate = 0.1, .reorder = 0.1, .seed = seed});
    cell.device.SetCuttingTorque(3.0);
    cell.TurnForASecond(20.0);
    EXPECT_EQ(cell.status().faults, 0u) << "a tenth lost is not a loss";
    EXPECT_NEAR(cell.status().torque_Nm, 3.0, kTorqueStep);
    EXPECT_NEAR(cell.device.tool_speed_rad_per_s(), 20.0, 0.1);
  }
}

TEST(Drive, IsConfiguredOverALossyBus) {
  DriveOnBus cell;
  cell.bus.SetParams({.loss = 0.05, .seed = 5});
  cell.Start();
  EXPECT_EQ(cell.drive.phase(), DrivePhase::kReady) << cell.drive.failure();
}

TEST(Drive, SharesABusWithTheForceSensor) {
  DriveOnBus cell;
  RobotousDevice sensor_device({});
  auto sensor = *io::RobotousSensor::Make({});
  cell.bus.Add(sensor);
  cell.bus.Add(sensor_device);
  cell.Start();
  sensor_device.SetLoad({.f = {0, 0, -120}, .t = {0, 0, 3}});
  cell.device.SetCuttingTorque(3.0);
  rt::Nanoseconds busiest = 0;
  cell.TurnForASecond(26.0);
  for (int i = 0; i < 100; ++i) {
    cell.Run(1);
    busiest = std::max(busiest, cell.bus.busy());
  }
  EXPECT_EQ(Wrench(sensor.Latest().F_S).f.z(), -120.0);
  EXPECT_NEAR(cell.status().torque_Nm, 3.0, kTorqueStep);
  EXPECT_LT(busiest, kMs) << "it has to fit the wire";
}

TEST(Drive, DoesNotAllocate) {
  DriveOnBus cell;
  cell.Start();
  cell.drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 20});
  {
    rt::CheckedNoAllocScope no_alloc;
    io::CanFrame frame;
    for (int i = 0; i < 200; ++i) {
      cell.now += kMs;
      while (cell.drive.Next(cell.now, frame)) cell.device.Accept({.frame = frame, .stamp = cell.now});
      while (cell.device.Next(cell.now, frame)) cell.drive.Accept({.frame = frame, .stamp = cell.now});
    }
  }
  EXPECT_EQ(cell.status().state, DriveState::kEnabled);
}

}  // namespace
}  // namespace osteon::hil
