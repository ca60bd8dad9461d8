#include "session/run/cell_ports.h"

#include <cstddef>
#include <utility>

#include <fmt/format.h>

#include "config/reading/load.h"
#include "io/net/free_ports.h"

namespace osteon::session {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::uint16_t kFirstTunnel = 29536;  // first tunnel port for a bus with a real interface

// Index of the guard's port among the cell's consecutive ports: after the port of the arm, the port of the
// PLC, and two ports for each CAN bus.
int GuardPlace(const config::CellConfig& cell) { return 2 + 2 * static_cast<int>(cell.devices.buses.size()); }
// Number of consecutive ports that the cell takes.
int PortCount(const config::CellConfig& cell) { return GuardPlace(cell) + (cell.guard ? 1 : 0); }

}  // namespace

std::string UseSimulatedWires(config::CellConfig& cell, std::optional<std::uint16_t> first_port) {
  constexpr int kMaxPort = 65535;
  if (!cell.has_simulation) return config::kWithoutSimulation;
  const int ports = PortCount(cell);
  if (first_port && *first_port > kMaxPort - ports + 1)
    return fmt::format("--port: found {}, accepted 0 … {}: the cell takes {} ports from there on",
                       *first_port, kMaxPort - ports + 1, ports);
  cell.link.host = kLoopback;
  cell.link.arm_host.clear();
  if (first_port) cell.link.port = *first_port;
  if (cell.guard) {
    cell.guard->host = kLoopback;
    if (first_port) cell.guard->port = static_cast<std::uint16_t>(*first_port + GuardPlace(cell));
  }
  if (cell.devices.plc) {
    cell.devices.plc->address = kLoopback;
    if (first_port)
      cell.devices.plc->port = cell.simulated_plc->port = static_cast<std::uint16_t>(*first_port + 1);
  }
  for (std::size_t i = 0; i < cell.devices.buses.size(); ++i) {
    io::CanBusParams& bus = cell.devices.buses[i];
    bus.interface.clear();
    if (first_port || bus.port == 0)
      bus.port = static_cast<std::uint16_t>((first_port ? *first_port + 2 : kFirstTunnel) + 2 * i);
    bus.device_port = static_cast<std::uint16_t>(bus.port + 1);
  }
  return "";
}

tl::expected<std::uint16_t, std::string> UseSimulated(config::CellConfig& cell,
                                                      std::optional<std::uint16_t> port) {
  if (port && *port == 0) {
    const auto free = io::FindFreePorts(PortCount(cell));
    if (!free) return free;
    port = *free;
  }
  if (std::string wrong = UseSimulatedWires(cell, port); !wrong.empty())
    return tl::make_unexpected(std::move(wrong));
  return port.value_or(0);
}

}  // namespace osteon::session
