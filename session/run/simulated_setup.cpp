#include "session/run/simulated_setup.h"

#include <variant>

namespace osteon::session {

hil::SimulatedCell MakeSimulatedCell(const config::CellConfig& cell, double seconds) {
  hil::ScriptParams script = cell.script;
  if (seconds > 0.0) std::visit([seconds](auto& s) { s.seconds = seconds; }, script);
  return {cell.simulated, MakeScript(script)};
}

hil::CellHostParams HostParams(const config::CellConfig& cell) {
  // the arm sends to the guard if there is one
  const std::string& host = cell.guard ? cell.guard->host : cell.link.host;
  const std::uint16_t port = cell.guard ? cell.guard->port : cell.link.port;
  return {.arm = {.client_address = host, .client_port = port, .injections = cell.injections},
          .wires = cell.devices,
          .devices = cell.simulated_devices,
          .plc = cell.simulated_plc};
}

}  // namespace osteon::session
