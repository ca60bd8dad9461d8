#pragma once

#include <memory>
#include <vector>

#include "hil/can/simulated_devices.h"
#include "hil/injection/impaired_can_bus.h"
#include "io/can/can_pump.h"
#include "io/devices/device_params.h"

namespace osteon::hil {

/// Counters of the faults injected into the wires of a simulated cell's CAN devices. Plain data.
struct DeviceWireCounters {
  WireCounters sensor_to_controller, sensor_from_controller;
  WireCounters drive_to_controller, drive_from_controller;
};

/// Connects the simulated devices to their ends of the CAN buses and injects a scenario's faults into each
/// device's frames. Works with wall time and virtual time. One thread at a time.
class DeviceWires {
 public:
  /// @param buses  the devices' ends, in the order of wires.buses; they and the devices must outlive this
  ///   object
  /// @param wires  the controller's parameters, which say which device is on which bus with which identifiers
  /// @param virtual_now  see ImpairedCanBus
  /// @throws std::invalid_argument from Validate(injections).
  DeviceWires(const std::vector<io::CanBus*>& buses, SimulatedDevices& devices, const io::DeviceParams& wires,
              const InjectionParams& injections, const rt::Nanoseconds* virtual_now = nullptr);

  /// Starts the injections' schedule at `now`, the time of the first COMMANDING_ACTIVE; later calls change
  /// nothing.
  void StartSchedule(rt::Nanoseconds now);
  /// Delivers received frames to the devices and sends the frames that are due.
  void Pump(rt::Nanoseconds now);

  [[nodiscard]] DeviceWireCounters counters() const;

 private:
  std::unique_ptr<ImpairedCanBus> sensor_, drive_;  // drive_: null if there is no drive
  std::vector<io::CanPump> pumps_;
};

}  // namespace osteon::hil
