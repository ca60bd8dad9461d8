#pragma once

#include <memory>
#include <vector>

#include "hil/can/simulated_devices.h"
#include "hil/injection/impaired_can_bus.h"
#include "io/can/can_pump.h"
#include "io/devices/device_params.h"

namespace osteon::hil {

/// What was injected into the wires of a simulated cell's CAN devices. Plain data.
struct DeviceWireCounters {
  WireCounters sensor_to_controller, sensor_from_controller;
  WireCounters drive_to_controller, drive_from_controller;
};

/// The simulated devices on their ends of the CAN buses, with what a scenario does to each one's frames. In
/// either clock. One thread at a time.
class DeviceWires {
 public:
  /// @param buses  the devices' ends, in the order of wires.buses; they and the devices outlive this
  /// @param wires  the cell as its controller has it: which device is on which bus, with which identifiers
  /// @param virtual_now  as ImpairedCanBus
  /// @throws std::invalid_argument from Validate(injections).
  DeviceWires(const std::vector<io::CanBus*>& buses, SimulatedDevices& devices, const io::DeviceParams& wires,
              const InjectionParams& injections, const rt::Nanoseconds* virtual_now = nullptr);

  /// COMMANDING_ACTIVE is seen at `now`; later calls change nothing.
  void Begin(rt::Nanoseconds now);
  /// Everybody takes what has come and sends what is due.
  void Pump(rt::Nanoseconds now);

  [[nodiscard]] DeviceWireCounters counters() const;

 private:
  std::unique_ptr<ImpairedCanBus> sensor_, drive_;  // drive_: null without one
  std::vector<io::CanPump> pumps_;
};

}  // namespace osteon::hil
