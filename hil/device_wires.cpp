#include "hil/device_wires.h"

#include "io/can/id_claims.h"

namespace osteon::hil {
namespace {

// Returns filters for the identifiers of a device's frames, in both directions.
std::vector<io::CanFilter> FramesOf(const std::vector<io::IdClaim>& claims) {
  std::vector<io::CanFilter> frames;
  for (const io::IdClaim& claim : claims)
    for (unsigned id = claim.first; id <= claim.last; ++id)
      frames.push_back({.id = static_cast<std::uint16_t>(id)});
  return frames;
}

}  // namespace

DeviceWires::DeviceWires(const std::vector<io::CanBus*>& buses, SimulatedDevices& devices,
                         const io::DeviceParams& wires, const InjectionParams& injections,
                         const rt::Nanoseconds* virtual_now) {
  const auto sensor_frames =
      FramesOf(std::visit([](const auto& params) { return io::Claims(params); }, wires.sensor));
  sensor_ = std::make_unique<ImpairedCanBus>(*buses.at(wires.sensor_bus), injections, Wire::kForceSensor,
                                             sensor_frames, virtual_now);
  const bool has_drive = wires.drive && devices.drive();
  // If both devices share one bus, the drive's impaired bus wraps the sensor's impaired bus, and one pump
  // serves both devices.
  const bool shared = has_drive && wires.drive_bus == wires.sensor_bus;
  if (has_drive)
    drive_ = std::make_unique<ImpairedCanBus>(
        shared ? static_cast<io::CanBus&>(*sensor_) : *buses.at(wires.drive_bus), injections, Wire::kDrive,
        FramesOf(io::Claims(*wires.drive)), virtual_now);

  pumps_.reserve(2);
  io::CanPump& first = pumps_.emplace_back(shared ? *drive_ : *sensor_);
  first.Add(devices.sensor());
  if (!has_drive) return;
  io::CanPump& second = shared ? first : pumps_.emplace_back(*drive_);
  second.Add(*devices.drive());
}

void DeviceWires::StartSchedule(rt::Nanoseconds now) {
  sensor_->StartSchedule(now);
  if (drive_) drive_->StartSchedule(now);
}

void DeviceWires::Pump(rt::Nanoseconds now) {
  for (io::CanPump& pump : pumps_) pump.Pump(now);
}

DeviceWireCounters DeviceWires::counters() const {
  DeviceWireCounters counters{.sensor_to_controller = sensor_->to_controller(),
                              .sensor_from_controller = sensor_->from_controller(),
                              .drive_to_controller = {},
                              .drive_from_controller = {}};
  if (drive_) {
    counters.drive_to_controller = drive_->to_controller();
    counters.drive_from_controller = drive_->from_controller();
  }
  return counters;
}

}  // namespace osteon::hil
