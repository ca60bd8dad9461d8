// Simulated CAN devices and their clients exchange frames over the virtual CAN interface (vcan) of a Linux
// kernel, in wall time, each with its own socket. run_in_uml.sh boots a user-mode Linux that has vcan, and
// runs the tests in it. There are no assertions on timing.

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

// Opens a socket on the interface that OSTEON_VCAN names. The machine's other sockets receive its frames.
std::unique_ptr<SocketCanBus> Open(std::vector<CanFilter> filters) {
  auto bus = SocketCanBus::Open(
      {.interface = std::getenv("OSTEON_VCAN"), .filters = std::move(filters), .local_loopback = true});
  EXPECT_TRUE(bus) << bus.error();
  return std::move(*bus);
}

// A client's and a device's end of one bus, both pumped by this thread.
struct BusEnds {
  BusEnds(CanClient& client, CanClient& device, std::vector<CanFilter> filters)
      : near(Open(std::move(filters))), far(Open({})), client_pump(*near), device_pump(*far) {
    client_pump.Add(client);
    device_pump.Add(device);
  }
  // @returns whether done() became true within 60 s.
  template <class Done>
  bool PumpUntil(Done&& done) {
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

// Load on both sensors [N, N m].
const Wrench kLoad{.f = {10, -20, 30}, .t = {0.5, -1, 2}};

// 100 Hz is a rate that a busy machine can sustain.
TEST(CanDevices, RobotousSensorMeasuresTheLoadOverVcan) {
  const RobotousParams params{.rate_hz = 100, .rate_readings = 20};
  auto sensor = *RobotousSensor::Make(params);
  hil::RobotousDevice device({});
  device.SetLoad(kLoad);
  BusEnds ends(sensor, device, Filters(params));
  ASSERT_TRUE(ends.PumpUntil([&] { return sensor.phase() != SensorPhase::kStarting; }));
  ASSERT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  ASSERT_TRUE(ends.PumpUntil([&] { return sensor.counters().readings > 50; }));
  EXPECT_LE((Vector3(sensor.Latest().F_S.f) - kLoad.f).norm(), 0.02);
  EXPECT_LE((Vector3(sensor.Latest().F_S.t) - kLoad.t).norm(), 0.001);
}

TEST(CanDevices, AtiSensorMeasuresTheLoadOverVcan) {
  auto sensor = *AtiSensor::Make({.period = 2 * rt::kMillisecond});
  hil::AtiDevice device({});
  device.SetLoad(kLoad);
  BusEnds ends(sensor, device, Filters(AtiParams{}));
  ASSERT_TRUE(ends.PumpUntil([&] { return sensor.phase() != SensorPhase::kStarting; }));
  ASSERT_EQ(sensor.phase(), SensorPhase::kReady) << sensor.failure();
  ASSERT_TRUE(ends.PumpUntil([&] { return sensor.counters().readings > 50; }));
  EXPECT_LE((Vector3(sensor.Latest().F_S.f) - kLoad.f).norm(), 0.05);
}

TEST(CanDevices, DriveReachesItsSpeedAndMeasuresTorqueOverVcan) {
  ReamerDriveParams params{.node = 16, .gear_ratio = 20, .rated_torque_Nm = 0.5, .max_speed_rad_per_s = 40};
  params.heartbeat = 200 * rt::kMillisecond;  // longer than in a cell: a busy machine may stall the guest
  params.missed_cycles = 250;
  auto drive = *ReamerDrive::Make(params);
  hil::DriveDevice device({});
  device.SetCuttingTorque(2.0);
  BusEnds ends(drive, device, Filters(params));
  ASSERT_TRUE(ends.PumpUntil([&] { return drive.phase() != DrivePhase::kStarting; }));
  ASSERT_EQ(drive.phase(), DrivePhase::kReady) << drive.failure();
  drive.Command({.goal = DriveGoal::kEnabled, .speed_rad_per_s = 10});
  EXPECT_TRUE(ends.PumpUntil([&] {
    return drive.status().faults != 0 || (std::abs(drive.status().speed_rad_per_s - 10) < 0.02 &&
                                          std::abs(drive.status().torque_Nm - 2.0) < 0.02);
  }));
  EXPECT_EQ(drive.status().faults, 0u);
}

}  // namespace
}  // namespace osteon::io
