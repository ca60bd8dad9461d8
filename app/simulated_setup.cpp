#include "app/simulated_setup.h"

#include <variant>

namespace osteon::app {

hil::SimulatedCell MakeSimulatedCell(const config::CellConfig& cell, double seconds) {
  hil::ScriptParams script = cell.script;
  if (seconds > 0.0) std::visit([seconds](auto& s) { s.seconds = seconds; }, script);
  return {cell.simulated, MakeScript(script)};
}

hil::CellHostParams HostParams(const config::CellConfig& cell) {
  return {.arm = {.client_address = cell.fri.host, .client_port = cell.fri.port},
          .buses = cell.devices.buses,
          .devices = cell.simulated_devices,
          .sensor_bus = cell.devices.sensor_bus,
          .drive_bus = cell.devices.drive_bus,
          .plc = cell.simulated_plc};
}

}  // namespace osteon::app
