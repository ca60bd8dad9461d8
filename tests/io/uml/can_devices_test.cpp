// Simulated devices and their clients over a real kernel's vcan, in wall time: see run_in_uml.sh. Each side
// has its own socket. There are no assertions on timing.

#include <cstdlib>

#include <gtest/gtest.h>

#include "hil/can/ati_device.h"
#include "hil/can/drive_device.h"
#include "hil/can/robotous_device.h"
#include "io/can/ati_sensor.h"
#include "io/can/can_pump.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"
#include "io/can/socket_can_bus.h"

namespace osteon::io {
namespace {

std::unique_ptr<SocketCanBus> Open(std::vector<CanFilter> filters) {
  auto bus = SocketCanBus::Open(
      {.interface = std::getenv("OSTEON_VCAN"), .filters = std::move(filters), .local_loopback = true});
  EXPECT_TRUE(bus) << bus.error();
  return std::move(*bus);
}

// Runs both ends of a bus in this thread until `done`.
struct Wire {
  Wire(CanClient& client, CanClient& device, std::vector<CanFilter> filters)
      : near(Open(std::move(filters))), far(Open({})), client_pump(*near), device_pump(*far) {
    client_pump.Add(client);
    device_pump.Add(device);
  }
  template <class Done>
  bool Until(Done&& done) {
    for (const rt::Nanoseconds end = rt::MonotonicNow() + 60 * rt::kSecond; rt::MonotonicNow() < end;) {
      EXPECT_EQ(client_pump.Pump(rt::MonotonicNow()), CanResult::kOk);
      EXPECT_EQ(device_pump.Pump(rt::MonotonicNow()), CanResult::kOk);
      if (done()) return true;
      rt::SleepUntil(rt::MonotonicNow() + 200'000);
    }
    return false;
  }
  std::unique_ptr<SocketCanBus> near, far;
  CanPump client_pump, device_pump;
};

const Wrench kLoad{.f = {10, -20, 30}, .t = {0.5, -1, 2}};

// The rate is one that a busy machine can keep up with.
TEST(CanDevices, RobotousOverVcan) {
  const RobotousParams params{.rate_hz = 100, .rate_readings = 20};
  auto sensor = *RobotousSensor::Make(params);
  hil::RobotousDevice device({});
  device.SetLoad(kLoad);
  Wire wire(sensor, device, Filters(params));
  ASSERT_TRUE(wire.Until([&] { return sensor.phase() != SensorPhase::kStarting; }));
  ASSERT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  ASSERT_TRUE(wire.Until([&] { return sensor.counters().readings > 50; }));
  EXPECT_LE((Vector3(sensor.Latest().F_S.f) - kLoad.f).norm(), 0.02);
  EXPECT_LE((Vector3(sensor.Latest().F_S.t) - kLoad.t).norm(), 0.001);
}

TEST(CanDevices, AtiOverVcan) {
  auto sensor = *AtiSensor::Make({.period = 2 * rt::kMillisecond});
  hil::AtiDevice device({});
  device.SetLoad(kLoad);
  Wire wire(sensor, device, Filters(AtiParams{}));
  ASSERT_TRUE(wire.Until([&] { return sensor.phase() != SensorPhase::kStarting; }));
  ASSERT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  ASSERT_TRUE(wire.Until([&] { return sensor.counters().readings > 50; }));
  EXPECT_LE((Vector3(sensor.Latest().F_S.f) - kLoad.f).norm(), 0.05);
}

TEST(CanDevices, DriveOverVcan) {
  ReamerDriveParams params{.node = 16, .gear_ratio = 20, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = 40};
  params.heartbeat = 200 * rt::kMillisecond;  // a busy machine may stall a guest for longer than a cell would
                                              // allow
  params.missed_cycles = 250;
  auto drive = *ReamerDrive::Make(params);
  hil::DriveDevice device({});
  device.SetCuttingTorque(2.0);
  Wire wire(drive, device, Filters(params));
  ASSERT_TRUE(wire.Until([&] { return drive.phase() != DrivePhase::kStarting; }));
  ASSERT_EQ(drive.phase(), DrivePhase::kReady) << drive.failure();
  drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 10});
  EXPECT_TRUE(wire.Until([&] {
    return drive.status().faults != 0 || (std::abs(drive.status().speed_rad_per_s - 10) < 0.02 &&
                                          std::abs(drive.status().torque_Nm - 2.0) < 0.02);
  }));
  EXPECT_EQ(drive.status().faults, 0u);
}

}  // namespace
}  // namespace osteon::io
