#include "config/reading/sections/read_devices.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "config/reading/sections/read_pose.h"
#include "config/reading/sections/read_tool_inertia.h"

namespace osteon::config {
namespace {

// largest speed command of a drive, as a multiple of the spindle's nominal speed
constexpr double kOverspeed = 1.2;
constexpr double kQuickStop = 4.0;  // slope of a quick stop, as a multiple of the slope of the usual ramp

rt::Nanoseconds ToNanoseconds(double seconds) {
  return static_cast<rt::Nanoseconds>(std::llround(seconds * 1e9));
}

// Reads the list `can`. A bus is a CAN interface of this machine, or a pair of UDP ports.
std::vector<io::CanBusParams> ReadBuses(Reader& cell) {
  std::vector<io::CanBusParams> buses;
  for (Reader& section : cell.Sections("can", 1, 4)) {
    io::CanBusParams& bus = buses.emplace_back();
    bus.name = section.Text("name");
    if (section.Has("interface")) {
      bus.interface = section.Text("interface");
    } else {
      bus.port = static_cast<std::uint16_t>(section.WholeNumber("udp_port", 1024, 65534));
      bus.device_port = static_cast<std::uint16_t>(bus.port + 1);
    }
  }
  return buses;
}

// Index of the bus that a device names; refuses an unknown name. Call after Finish().
std::size_t BusOf(const DeviceBus& device, const std::vector<io::CanBusParams>& buses) {
  std::string all;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    if (buses[i].name == device.name) return i;
    all += (all.empty() ? "" : ", ") + buses[i].name;
  }
  device.section.Refuse("bus", fmt::format("found {}, accepted one of can: {}", device.name, all));
}

// Reads a force sensor's section `simulated`: its noise, bias, drift and range.
hil::SensorModelParams ReadSensorModel(Reader section) {
  hil::SensorModelParams model;
  model.noise_N = section.Number("noise_N", 0, 10);
  model.noise_Nm = section.Number("noise_Nm", 0, 1);
  const Vector3 bias_N = section.Triple("bias_N", -100, 100), bias_Nm = section.Triple("bias_Nm", -10, 10);
  model.bias = Wrench{.f = bias_N, .t = bias_Nm};
  model.drift_N_per_s = section.Triple("drift_N_per_s", -10, 10);
  model.drift_Nm_per_s = section.Triple("drift_Nm_per_s", -1, 1);
  model.range_N = section.Number("range_N", 1, 10000);
  model.range_Nm = section.Number("range_Nm", 0.1, 1000);
  return model;
}

// Reads section `force_sensor`, for the loop's driver and for the simulated device.
void ReadSensor(Reader section, CellConfig& cell) {
  cell.servo.sensor.X_FS = ReadPose(section);
  ReadToolInertia(section, cell.servo.sensor);
  const bool robotous = section.Choice("type", {"robotous", "ati"}) == 0;
  hil::SensorModelParams model;
  if (cell.has_simulation || section.Has("simulated")) model = ReadSensorModel(section.Section("simulated"));
  if (robotous) {
    cell.devices.sensor = io::RobotousParams{};
    cell.simulated_devices.sensor = hil::RobotousDeviceParams{.model = model};
  } else {
    io::AtiParams ati;
    hil::AtiDeviceParams device{.model = model};
    if (section.Has("base_count")) device.base = section.WholeNumber("base_count", 0, 127);
    ati.base = static_cast<std::uint8_t>(device.base);
    cell.devices.sensor = ati;
    cell.simulated_devices.sensor = device;
  }
}

// Reads section `drive`, for the loop's driver and for the simulated device.
void ReadDrive(Reader section, CellConfig& cell) {
  io::ReamerDriveParams& drive = cell.devices.drive.emplace();
  drive.node = static_cast<std::uint8_t>(section.WholeNumber("node_count", 1, 126));
  drive.cycle = ToNanoseconds(section.Number("cycle_ms", 1, 50));
  const double lost_s = section.Number("lost_ms", 5, 1000);
  drive.missed_cycles = static_cast<int>(std::lround(1e9 * lost_s / static_cast<double>(drive.cycle)));
  cell.servo.watchdog.spindle_stop_s = lost_s;
  if (section.Has("heartbeat_ms")) {
    drive.heartbeat = ToNanoseconds(section.Number("heartbeat_ms", 10, 100));
    if (drive.heartbeat % rt::kMillisecond != 0)
      section.Refuse("heartbeat_ms",
                     fmt::format("found {:.10g}, accepted whole milliseconds: the drive counts in them",
                                 1e-6 * static_cast<double>(drive.heartbeat)));
  }
  cell.simulated_devices.drive.emplace().node = drive.node;
}

// Reads section `plc`, for the loop's client and for the simulated server.
void ReadPlc(Reader section, CellConfig& cell) {
  io::PlcClientParams& plc = cell.devices.plc.emplace();
  plc.address = section.Text("host");
  plc.port = static_cast<std::uint16_t>(section.WholeNumber("port", 1, 65535));
  cell.devices.plc_max_age = ToNanoseconds(section.Number("max_age_ms", 20, 1000));
  hil::PlcServerParams& server = cell.simulated_plc.emplace();
  server.port = plc.port;
  server.logic.guard = section.Bool("guard");
}

// Without a PLC, no input of Osteon can withdraw the permission to move. The cell's file must therefore state
// explicitly that there is none.
void RequirePlcOrItsAbsence(const DeviceSections& sections, const CellConfig& cell) {
  if (cell.devices.plc && sections.without_plc)
    sections.cell.Refuse("without_plc",
                         "found beside plc, accepted one of the two; a file that extends another drops its "
                         "section with remove: [plc]");
  if (!cell.devices.plc && !sections.without_plc)
    sections.cell.Refuse(
        "plc",
        "found none, accepted a section with host, port, max_age_ms and guard; of a cell in which "
        "the arm's own safety controller alone keeps it from moving: without_plc: accepted");
}

}  // namespace

DeviceSections ReadDevices(Reader& reader, Reader& force_sensor, CellConfig& cell) {
  cell.devices.buses = ReadBuses(reader);
  ReadSensor(force_sensor, cell);
  DeviceSections sections{.cell = reader, .sensor = {force_sensor, force_sensor.Text("bus")}, .drive = {}};
  if (reader.Has("drive")) {
    Reader drive = reader.Section("drive");
    ReadDrive(drive, cell);
    sections.drive = DeviceBus{drive, drive.Text("bus")};
  }
  if (reader.Has("plc")) ReadPlc(reader.Section("plc"), cell);
  sections.without_plc = reader.Has("without_plc");
  if (sections.without_plc) static_cast<void>(reader.Choice("without_plc", {"accepted"}));
  return sections;
}

void CompleteDevices(const DeviceSections& sections, CellConfig& cell) {
  cell.devices.sensor_bus = BusOf(sections.sensor, cell.devices.buses);
  if (sections.drive) cell.devices.drive_bus = BusOf(*sections.drive, cell.devices.buses);

  const simulation::Tool& tool = cell.tool.tool;
  control::ForceSensorParams& sensor = cell.servo.sensor;
  sensor.tool_mass_kg = tool.mass_kg;
  sensor.tool_center_F_m = Vector3(cell.tool.X_FT * Vector3(tool.center_of_mass_m));
  sensor.tool_inertia_F =
      Matrix3(cell.tool.X_FT.linear() * Matrix3(tool.inertia_kg_m2) * cell.tool.X_FT.linear().transpose());
  cell.simulated.sensor = sensor;

  if (cell.devices.drive) {
    const ToolDriveConfig& motor = cell.tool.drive;
    const double speed = cell.tool.spindle_rad_per_s;
    io::ReamerDriveParams& drive = *cell.devices.drive;
    drive.gear_ratio = motor.gear_ratio;
    drive.rated_torque_Nm = motor.rated_torque_Nm;
    drive.max_speed_rad_per_s = kOverspeed * speed;
    drive.acceleration_rad_per_s2 = speed / motor.spin_up_s;
    drive.quick_stop_rad_per_s2 = kQuickStop * drive.acceleration_rad_per_s2;
    hil::DriveMotorParams& simulated = cell.simulated_devices.drive->motor;
    simulated.gear_ratio = motor.gear_ratio;
    simulated.rated_torque_Nm = motor.rated_torque_Nm;
    // assumption: the motor accelerates its tool with half of its rated torque
    simulated.inertia_kg_m2 =
        0.5 * motor.rated_torque_Nm / (motor.gear_ratio * drive.acceleration_rad_per_s2);
  }
  cell.servo.has_spindle = cell.devices.drive.has_value();
  RequirePlcOrItsAbsence(sections, cell);
  cell.servo.has_interlock = cell.devices.plc.has_value();
  if (cell.devices.plc) cell.servo.watchdog.interlock_stop_s = rt::ToSeconds(cell.devices.plc_max_age);

  for (std::size_t i = 0; i < cell.devices.buses.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (cell.devices.buses[i].name == cell.devices.buses[j].name)
        sections.cell.Refuse("can", fmt::format("found two buses of the name {}, accepted different ones",
                                                cell.devices.buses[i].name));
  if (const auto overlap = io::FindOverlap(cell.devices)) sections.cell.Refuse("can", *overlap);
}

}  // namespace osteon::config
