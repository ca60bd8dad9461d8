// Tests the clients of force sensor and spindle drive as the servo loop uses them. They are connected to the
// simulated devices by CAN buses in memory, in virtual time.

#include <deque>

#include <gtest/gtest.h>

#include "hil/can/memory_can_bus.h"
#include "hil/device_wires.h"
#include "io/devices/device_clients.h"

namespace osteon::hil {
namespace {

constexpr double kSpeed = 26.0;  // speed of the tool [rad/s]

// Parameters of the clients: a sensor of one of the two makes, and a drive on the sensor's bus or on a bus of
// its own.
io::DeviceParams ClientParams(bool ati, bool two_buses) {
  io::DeviceParams wires;
  wires.buses = {{.name = "tool", .interface = "", .port = 1, .device_port = 2}};
  if (two_buses) wires.buses.push_back({.name = "drive", .interface = "", .port = 3, .device_port = 4});
  if (ati) wires.sensor = io::AtiParams{};
  wires.drive = io::ReamerDriveParams{.gear_ratio = 20.0,
                                      .rated_torque_Nm = 0.5,
                                      .max_speed_rad_per_s = 1.2 * kSpeed,
                                      .acceleration_rad_per_s2 = kSpeed / 0.3};
  wires.drive_bus = two_buses ? 1 : 0;
  return wires;
}

// Parameters of the simulated sensor and drive.
SimulatedDeviceParams SimulatedParams(bool ati) {
  SimulatedDeviceParams params;
  if (ati) params.sensor = AtiDeviceParams{};
  params.drive = DriveDeviceParams{};
  return params;
}

// The clients and the simulated devices of a cell, in virtual time with steps of a millisecond.
class Cell {
 public:
  explicit Cell(bool ati = false, bool two_buses = false, const InjectionParams& injections = {})
      : devices_(SimulatedParams(ati)) {
    const io::DeviceParams wires = ClientParams(ati, two_buses);
    auto made = io::DeviceClients::Make(wires);
    if (!made) throw std::invalid_argument(made.error());
    clients = std::move(*made);
    std::vector<io::CanBus*> ends;
    pumps_.reserve(2);
    for (std::size_t i = 0; i < wires.buses.size(); ++i) {
      MemoryCanBus &ours = buses_.emplace_back(now), &theirs = buses_.emplace_back(now);
      MemoryCanBus::Join(ours, theirs);
      ends.push_back(&theirs);
      clients->AddToPump(pumps_.emplace_back(ours), i);
    }
    wires_.emplace(ends, devices_, wires, injections, &now);
  }

  /// @returns the readings that the loop gets after this time
  control::CellReadings Run(int ms) {
    for (int i = 0; i < ms; ++i) {
      now += rt::kMillisecond;
      clients->Command(commands, now);
      devices_.SetLoad(load_S);
      wires_->Pump(now);
      for (io::CanPump& pump : pumps_) pump.Pump(now);
    }
    return clients->Readings({}, now);
  }
  DeviceWires& wires() { return *wires_; }
  DriveDevice& drive() { return *devices_.drive(); }
  /// Sets the commands of a cell in which nothing has moved yet.
  void WaitForTheFirstMotion() { commands = {.motion_requested = true, .clear_faults = true}; }

  rt::Nanoseconds now{0};
  control::CellCommands commands;
  Wrench load_S{.f = Vector3::Zero(), .t = Vector3::Zero()};
  std::unique_ptr<io::DeviceClients> clients;

 private:
  SimulatedDevices devices_;
  std::deque<MemoryCanBus> buses_;
  std::vector<io::CanPump> pumps_;
  std::optional<DeviceWires> wires_;
};

class BothMakesAndBusLayouts : public ::testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(BothMakesAndBusLayouts, TheReadingsAreTheSensorsLoadAndTheDrivesSpeed) {
  const auto [ati, two_buses] = GetParam();
  Cell cell(ati, two_buses);
  cell.load_S = {.f = {12.3, -45.6, 78.9}, .t = {1.25, -0.5, 3.5}};
  cell.Run(600);
  EXPECT_EQ(cell.clients->Diagnosis({}, cell.now), "");
  cell.commands.spindle_rad_per_s = kSpeed;
  const control::CellReadings readings = cell.Run(1000);
  EXPECT_TRUE(readings.force.trusted);
  EXPECT_LE(cell.now - readings.force.stamp, 2 * rt::kMillisecond);
  // the tolerances cover the resolution of both makes: 1/50 N and 1/2000 N·m for Robotous, some thousand
  // counts of the range for ATI
  EXPECT_LT((Vector3(readings.force.F_S.f) - cell.load_S.f).norm(), 0.1);
  EXPECT_LT((Vector3(readings.force.F_S.t) - cell.load_S.t).norm(), 0.02);
  EXPECT_TRUE(readings.spindle.ready);
  EXPECT_FALSE(readings.spindle.fault);
  EXPECT_LE(cell.now - readings.spindle.stamp, 8 * rt::kMillisecond);
  EXPECT_NEAR(readings.spindle.speed_rad_per_s, kSpeed, 0.02 * kSpeed);
}

INSTANTIATE_TEST_SUITE_P(CellDevices, BothMakesAndBusLayouts,
                         ::testing::Values(std::tuple{false, false}, std::tuple{false, true},
                                           std::tuple{true, false}, std::tuple{true, true}));

TEST(CellDevices, AnOverloadedSensorIsNotTrusted) {
  Cell cell;
  cell.load_S.f = {0.0, 0.0, -600.0};
  EXPECT_FALSE(cell.Run(600).force.trusted);
  EXPECT_NE(cell.clients->Diagnosis({}, cell.now).find("force sensor"), std::string::npos);
}

TEST(CellDevices, AQuickStopBrakesTheSpindleFasterThanItsRamp) {
  const auto time_to_rest_ms = [](bool quick) {
    Cell cell;
    cell.commands.spindle_rad_per_s = kSpeed;
    EXPECT_NEAR(cell.Run(2000).spindle.speed_rad_per_s, kSpeed, 1.0);
    cell.commands = {.quick_stop = quick};
    int ms = 0;
    while (cell.Run(1).spindle.speed_rad_per_s > 0.05 * kSpeed && ms < 5000) ++ms;
    EXPECT_FALSE(cell.Run(500).spindle.fault) << "it was told so";
    return ms;
  };
  const int ramped = time_to_rest_ms(false), quick = time_to_rest_ms(true);
  EXPECT_GT(ramped, 150);
  EXPECT_LT(ramped, 600);
  EXPECT_LT(quick, ramped);
}

// The loop commands a quick stop for one millisecond only, as if it recovered at once. The spindle must still
// come to rest before it turns again.
TEST(CellDevices, AQuickStopLastsUntilStandstill) {
  Cell cell;
  cell.commands.spindle_rad_per_s = kSpeed;
  cell.Run(2000);
  cell.commands.quick_stop = true;
  cell.Run(1);
  cell.commands.quick_stop = false;
  double slowest_rad_per_s = kSpeed;
  for (int ms = 0; ms < 2000; ++ms) {
    const control::SpindleReading spindle = cell.Run(1).spindle;
    EXPECT_FALSE(spindle.fault) << "it was told so";
    slowest_rad_per_s = std::min(slowest_rad_per_s, spindle.speed_rad_per_s);
  }
  EXPECT_LT(slowest_rad_per_s, 0.5);
  EXPECT_NEAR(cell.Run(1).spindle.speed_rad_per_s, kSpeed, 0.02 * kSpeed);
}

TEST(CellDevices, ADriveFaultStaysUntilARecoveryClearsIt) {
  const InjectionParams silence{
      .injections = {{.wire = Wire::kDrive, .from_s = 0.0, .to_s = 0.5, .faults = {.silence = true}}}};
  Cell cell(false, false, silence);
  cell.commands.spindle_rad_per_s = kSpeed;
  cell.Run(1000);
  cell.wires().StartSchedule(cell.now);
  EXPECT_TRUE(cell.Run(600).spindle.fault);
  cell.commands = {.motion_requested = true, .quick_stop = true};
  EXPECT_TRUE(cell.Run(1000).spindle.fault) << "heard again, it is still one";
  cell.commands = {.motion_requested = true, .clear_faults = true};
  const control::CellReadings readings = cell.Run(1000);
  EXPECT_FALSE(readings.spindle.fault);
  EXPECT_LT(readings.spindle.speed_rad_per_s, 0.5) << "and does not start by itself";
}

// Before the first motion, the client itself resets a fault of the drive (controlword bit 7), so that nobody
// has to reset it by hand.
TEST(CellDevices, ADriveThatBootsInFaultIsResetOnce) {
  Cell cell;
  cell.drive().SetBootError(0x3220);
  cell.WaitForTheFirstMotion();
  control::CellReadings readings;
  bool seen = false;
  for (int ms = 0; ms < 600; ++ms) {
    readings = cell.Run(1);
    const control::SpindleReading& s = readings.spindle;
    const bool in_fault = (cell.drive().statusword() & 0x4F) == 0x08;
    EXPECT_FALSE(s.ready && s.stamp > 0 && in_fault && !s.fault) << ms << " ms: nothing may begin meanwhile";
    if (s.faults == 0 || seen) continue;
    seen = true;
    EXPECT_EQ(s.faults, io::kDriveInFault);
    EXPECT_EQ(s.error_code, 0x3220);
    EXPECT_EQ(s.emergency_code, 0x3220);
    EXPECT_EQ(s.nmt_state, 5);
    const std::string text = cell.clients->Diagnosis({}, cell.now);
    EXPECT_NE(text.find("in fault by its statusword (bit 3)"), std::string::npos) << text;
    EXPECT_NE(text.find("603F 0x3220 (under-voltage of the DC link)"), std::string::npos) << text;
  }
  EXPECT_TRUE(seen);
  EXPECT_EQ(cell.drive().resets(), 1);
  EXPECT_TRUE(readings.spindle.ready);
  EXPECT_FALSE(readings.spindle.fault);
  EXPECT_EQ(cell.drive().statusword() & 0x4F, 0x40) << "off, as it was commanded";
}

TEST(CellDevices, ADriveThatStaysInFaultIsResetOnlyThreeTimes) {
  Cell cell;
  cell.drive().InjectFault(0x4310);
  cell.WaitForTheFirstMotion();
  EXPECT_TRUE(cell.Run(5000).spindle.fault);
  EXPECT_EQ(cell.drive().resets(), io::DriveReset::kAttempts);
  const std::string text = cell.clients->Diagnosis({}, cell.now);
  EXPECT_NE(text.find("603F 0x4310 (excess temperature of the drive)"), std::string::npos) << text;
  EXPECT_NE(text.find("3 resets have not cleared it"), std::string::npos) << text;
  cell.commands.clear_faults = false;
  cell.Run(100);
  cell.drive().ClearFault();
  cell.WaitForTheFirstMotion();  // as in a recovery, in which the reset may be tried once more
  EXPECT_FALSE(cell.Run(1000).spindle.fault);
}

TEST(CellDevices, NoFaultIsResetDuringARun) {
  Cell cell;
  cell.commands = {.motion_requested = true, .spindle_rad_per_s = kSpeed};
  cell.Run(1000);
  cell.drive().InjectFault(0x4310);
  cell.Run(100);
  cell.drive().ClearFault();
  for (const bool quick : {true, false}) {
    cell.commands = {.motion_requested = true, .quick_stop = quick};
    EXPECT_TRUE(cell.Run(2000).spindle.fault);
  }
  EXPECT_EQ(cell.drive().resets(), 0);
}

TEST(CellDevices, ADriveThatBootsWhileTheCellWaitsIsConfiguredAnew) {
  Cell cell;
  cell.WaitForTheFirstMotion();
  cell.Run(600);
  cell.drive().SetPower(false);
  EXPECT_TRUE(cell.Run(300).spindle.fault);
  EXPECT_EQ(cell.drive().resets(), 0) << "nobody is there to be reset";
  cell.drive().SetPower(true);
  const control::CellReadings readings = cell.Run(2000);
  EXPECT_TRUE(readings.spindle.ready);
  EXPECT_FALSE(readings.spindle.fault);
  cell.commands = {.motion_requested = true, .spindle_rad_per_s = kSpeed};
  EXPECT_NEAR(cell.Run(1000).spindle.speed_rad_per_s, kSpeed, 0.02 * kSpeed);
}

TEST(CellDevices, ASilentSensorLeavesTheDriveUnaffected) {
  const InjectionParams silence{
      .injections = {{.wire = Wire::kForceSensor, .from_s = 0.5, .faults = {.silence = true}}}};
  Cell cell(false, false, silence);
  cell.Run(600);
  cell.wires().StartSchedule(cell.now);
  const control::CellReadings readings = cell.Run(1000);
  EXPECT_NEAR(rt::ToSeconds(cell.now - readings.force.stamp), 0.5, 0.003);
  EXPECT_LE(cell.now - readings.spindle.stamp, 8 * rt::kMillisecond);
  EXPECT_GT(cell.wires().counters().sensor_to_controller.silenced, 900u);
  EXPECT_EQ(cell.wires().counters().drive_to_controller.silenced, 0u);
}

TEST(CellDevices, AMotionRequestIsRepeatedUntilThePlcGrantsIt) {
  const Cell cell;
  const control::CellCommands wanted{.motion_requested = true};
  io::PlcReading plc;
  int rising_edges = 0;
  bool before = false;
  for (int ms = 1; ms <= 3000; ++ms) {
    const bool now = cell.clients->UpdateMotionRequest(wanted, plc, ms * rt::kMillisecond);
    rising_edges += now && !before;
    before = now;
  }
  EXPECT_GE(rising_edges, 4);
  EXPECT_LE(rising_edges, 8);
  plc.inputs.run_permitted = true;
  static_cast<void>(cell.clients->UpdateMotionRequest(wanted, plc, 3600 * rt::kMillisecond));
  for (int ms = 3700; ms <= 9000; ++ms)
    ASSERT_TRUE(cell.clients->UpdateMotionRequest(wanted, plc, ms * rt::kMillisecond))
        << "granted: it stands";
  EXPECT_FALSE(cell.clients->UpdateMotionRequest({}, plc, 9001 * rt::kMillisecond));
}

TEST(CellDevices, DevicesOfOneBusThatShareIdentifiersAreRefused) {
  io::DeviceParams wires = ClientParams(true, false);
  wires.drive->node = 5;  // the RPDO1 of node 5 has the identifier 0x205, which an ATI sensor uses as well
  const auto made = io::DeviceClients::Make(wires);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().find("node 5"), std::string::npos) << made.error();
  wires = ClientParams(true, true);
  wires.drive->node = 5;
  EXPECT_TRUE(io::DeviceClients::Make(wires)) << "a bus of its own";
}

TEST(CellDevices, DevicesThatAreSwitchedOnLateAreFound) {
  // sensor and drive are silent for the first two seconds, which is longer than the clients try
  const InjectionParams silence{
      .injections = {{.wire = Wire::kForceSensor, .from_s = -1.0, .to_s = 2.0, .faults = {.silence = true}},
                     {.wire = Wire::kDrive, .from_s = -1.0, .to_s = 2.0, .faults = {.silence = true}}}};
  Cell cell(false, false, silence);
  cell.wires().StartSchedule(cell.now);
  cell.Run(900);
  EXPECT_NE(cell.clients->Diagnosis({}, cell.now).find("force sensor"), std::string::npos);
  const control::CellReadings late = cell.Run(4000);
  EXPECT_EQ(cell.clients->Diagnosis({}, cell.now), "");
  EXPECT_TRUE(late.spindle.ready);
  EXPECT_LT(cell.now - late.force.stamp, 5 * rt::kMillisecond);
}

TEST(CellDevices, DiagnosisNamesSilentDevices) {
  auto clients = io::DeviceClients::Make(ClientParams(false, false));
  ASSERT_TRUE(clients);
  const std::string text = (*clients)->Diagnosis({}, rt::kSecond);
  EXPECT_NE(text.find("force sensor"), std::string::npos) << text;
  EXPECT_NE(text.find("reamer drive"), std::string::npos) << text;
}

TEST(CellDevices, DiagnosisNamesAnEnablingSwitchThatIsNotHeld) {
  io::DeviceParams params = ClientParams(false, false);
  params.plc.emplace();
  auto clients = io::DeviceClients::Make(params);
  ASSERT_TRUE(clients);
  io::PlcReading plc{.stamp = rt::kSecond, .link = io::PlcLink::kConnected, .heartbeat_changed = rt::kSecond};
  plc.inputs.emergency_stop = false;
  plc.inputs.run_permitted = true;
  for (const auto enabling :
       {io::PlcEnabling::kReleased, io::PlcEnabling::kEnabled, io::PlcEnabling::kSqueezed}) {
    const bool held = enabling == io::PlcEnabling::kEnabled;
    plc.inputs.enabling = enabling;
    EXPECT_EQ((*clients)->Readings(plc, rt::kSecond).interlock.enabled, held);
    EXPECT_TRUE((*clients)->Readings(plc, rt::kSecond).interlock.permitted) << "that is the PLC's";
    EXPECT_EQ((*clients)->Diagnosis(plc, rt::kSecond).find("ENABLING_SWITCH (979)") == std::string::npos,
              held)
        << (*clients)->Diagnosis(plc, rt::kSecond);
  }
}

}  // namespace
}  // namespace osteon::hil
