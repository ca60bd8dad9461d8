#include "session/setup/cell_checks.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "io/fri/fri_link.h"
#include "io/net/network_probe.h"
#include "session/run/arm_connection.h"

namespace osteon::session {
namespace {

constexpr int kCanHardware = 280;      // ARPHRD_CAN of linux/if_arp.h, as sysfs shows it
constexpr unsigned kSwitchedOn = 0x1;  // IFF_UP

bool IsLoopback(const std::string& address) { return address.starts_with("127."); }

// Checks the network card with this address, at which the messages of `who` ("Arm", "Guard") arrive.
Check CardCheck(const std::string& who, const std::string& address) {
  const std::string name = who + "'s network card";
  const auto card = io::FindNetworkCard(address);
  if (IsLoopback(address))
    return {name, address + ", the loopback", kCheckUsable,
            "of a simulated arm: for a real one `host` is the address of this PC's card"};
  if (!card)
    return {name, address + ", of no card here", kCheckMissing,
            fmt::format("sudo ip address add {}/24 dev CARD, or correct `host` (docs/set_up.md)", address)};
  if (!card->is_up)
    return {name, fmt::format("{}, {} is down", address, card->name), kCheckMissing,
            fmt::format("sudo ip link set {} up", card->name)};
  return {name, fmt::format("{}, {}", address, card->name + (card->has_cable ? "" : ", no carrier")),
          card->has_cable ? kCheckGood : kCheckMissing,
          card->has_cable ? "" : "plug in the cable, and switch the other end on"};
}

// Examines the network cards of arm and guard, and tries to open the ports at which their messages arrive.
void ExamineArm(std::vector<Check>& checks, const config::CellConfig& cell) {
  const config::ArmLinkConfig& link = cell.link;
  const std::string protocol = link.fri() != nullptr ? "FRI" : "RSI";
  checks.push_back(CardCheck("Arm", link.host));
  const auto connection = ArmConnection::Open(link, link.arm_host);
  checks.push_back({"Arm's port", fmt::format("{} at {}:{}", protocol, link.host, link.port),
                    connection ? kCheckGood : kCheckMissing, connection ? "" : connection.error()});
  if (!cell.guard) return;
  if (cell.guard->host != link.host) checks.push_back(CardCheck("Guard", cell.guard->host));
  const auto guard = io::FriLink::Open({.bind_address = cell.guard->host, .port = cell.guard->port});
  checks.push_back({"Guard's port", fmt::format("{}:{}", cell.guard->host, cell.guard->port),
                    guard ? kCheckGood : kCheckMissing, guard ? "" : guard.error()});
}

// Checks that the bus's interface exists, is a CAN interface, and is up, by its files in /sys/class/net.
Check BusCheck(const io::CanBusParams& bus) {
  const std::string name = "CAN bus " + bus.name;
  if (bus.interface.empty())
    return {name, fmt::format("simulated, by UDP port {}", bus.port), kCheckUsable,
            "for a real sensor and drive: `interface: can0` in place of `udp_port`"};
  const std::filesystem::path folder = std::filesystem::path("/sys/class/net") / bus.interface;
  int hardware = 0;
  if (std::ifstream type(folder / "type"); !(type >> hardware))
    return {name, bus.interface + ", not on this machine", kCheckMissing,
            "plug the CAN adapter in, or correct `interface`: ip -brief link lists what there is"};
  if (hardware != kCanHardware)
    return {name, bus.interface + ", no CAN interface", kCheckMissing,
            "correct `interface`: ip -brief link show type can lists what there is"};
  unsigned flags = 0;
  std::ifstream(folder / "flags") >> std::hex >> flags;
  const bool is_up = (flags & kSwitchedOn) != 0;
  return {name, bus.interface + (is_up ? ", up" : ", down"), is_up ? kCheckGood : kCheckMissing,
          is_up
              ? ""
              : fmt::format("sudo ip link set {} up type can bitrate 1000000 restart-ms 100", bus.interface)};
}

// Checks that the PLC accepts a connection.
Check PlcCheck(const config::CellConfig& cell) {
  if (!cell.devices.plc)
    return {"PLC", "none: without_plc", kCheckUsable,
            "no enabling switch, pedal or emergency stop is read (docs/set_up.md)"};
  const io::PlcClientParams& plc = *cell.devices.plc;
  const std::string why = io::WhyNoTcpConnection(plc.address, plc.port, plc.connect_timeout_ms);
  const std::string at = fmt::format("{}:{}", plc.address, plc.port);
  if (IsLoopback(plc.address))
    return {"PLC", at + (why.empty() ? ", answers on this machine" : ", simulated: not running"),
            kCheckUsable,
            "of a simulated cell, which starts it; for a real one `plc: host` is the PLC's address"};
  return {"PLC", at + (why.empty() ? ", accepts a connection" : ", " + why),
          why.empty() ? kCheckGood : kCheckMissing,
          why.empty() ? "" : "is it switched on, in this network, and does it serve Modbus TCP there?"};
}

}  // namespace

void ExamineCell(std::vector<Check>& checks, const config::CellConfig& cell) {
  const std::size_t before = checks.size();
  ExamineArm(checks, cell);
  for (const io::CanBusParams& bus : cell.devices.buses) checks.push_back(BusCheck(bus));
  checks.push_back(PlcCheck(cell));
  for (std::size_t i = before; i < checks.size(); ++i) checks[i].is_required = true;
}

}  // namespace osteon::session
