#include "app/cell_ports.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstddef>

namespace osteon::app {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::uint16_t kFirstTunnel = 29536;     // of a bus whose file names a real interface
constexpr int kLowest = 20000, kHighest = 32000;  // below what systems hand out by themselves

int PortsOf(const config::CellConfig& cell) { return 2 + 2 * static_cast<int>(cell.devices.buses.size()); }

bool IsFree(int type, int port) {
  const int socket = ::socket(AF_INET, type, 0);
  if (socket < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const bool free = bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(socket);
  return free;
}

}  // namespace

void UseSimulatedWires(config::CellConfig& cell, std::optional<std::uint16_t> first_port) {
  cell.fri.host = kLoopback;
  if (first_port) cell.fri.port = *first_port;
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
}

tl::expected<std::uint16_t, std::string> UseSimulated(config::CellConfig& cell,
                                                      std::optional<std::uint16_t> port) {
  if (port && *port == 0) {
    const auto free = FreePorts(cell);
    if (!free) return free;
    port = *free;
  }
  UseSimulatedWires(cell, port);
  return port.value_or(0);
}

tl::expected<std::uint16_t, std::string> FreePorts(const config::CellConfig& cell) {
  const int count = PortsOf(cell), range = kHighest - kLowest;
  for (int tried = 0; tried < range; tried += count) {
    // processes begin at different places, so that two that start together seldom meet
    const int first = kLowest + (getpid() * 8 + tried) % range;
    int free = 0;
    while (free < count && IsFree(SOCK_DGRAM, first + free) && IsFree(SOCK_STREAM, first + free)) ++free;
    if (free == count) return static_cast<std::uint16_t>(first);
  }
  return tl::make_unexpected("no " + std::to_string(count) + " free ports in a row between " +
                             std::to_string(kLowest) + " and " + std::to_string(kHighest));
}

}  // namespace osteon::app
