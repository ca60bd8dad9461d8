#include "io/devices/wired_devices.h"

#include "io/can/socket_can_bus.h"
#include "io/can/udp_can_bus.h"

namespace osteon::io {
namespace {

// Converts the result of opening a SocketCanBus or a UdpCanBus to the interface CanBus.
template <class Bus>
tl::expected<std::unique_ptr<CanBus>, std::string> AsBus(
    tl::expected<std::unique_ptr<Bus>, std::string> opened) {
  if (!opened) return tl::make_unexpected(opened.error());
  return std::unique_ptr<CanBus>(std::move(*opened));
}

// Opens SocketCAN if the bus has an interface, otherwise the UDP tunnel.
tl::expected<std::unique_ptr<CanBus>, std::string> OpenBus(const CanBusParams& bus,
                                                           const std::vector<CanFilter>& filters) {
  if (!bus.interface.empty())
    return AsBus(SocketCanBus::Open({.interface = bus.interface, .filters = filters}));
  return AsBus(UdpCanBus::Open({.bind_port = bus.port, .peer_port = bus.device_port, .filters = filters}));
}

}  // namespace

tl::expected<std::unique_ptr<WiredDevices>, std::string> WiredDevices::Open(const DeviceParams& params) {
  auto clients = DeviceClients::Make(params);
  if (!clients) return tl::make_unexpected(clients.error());
  std::unique_ptr<WiredDevices> devices(new WiredDevices);
  devices->clients_ = std::move(*clients);
  devices->pumps_.reserve(params.buses.size());
  for (std::size_t i = 0; i < params.buses.size(); ++i) {
    std::vector<CanFilter> filters;
    const auto add = [&](const std::vector<CanFilter>& more) {
      filters.insert(filters.end(), more.begin(), more.end());
    };
    if (params.sensor_bus == i) add(std::visit([](const auto& p) { return Filters(p); }, params.sensor));
    if (params.drive && params.drive_bus == i) add(Filters(*params.drive));
    auto bus = OpenBus(params.buses[i], filters);
    if (!bus) return tl::make_unexpected("CAN bus " + params.buses[i].name + ": " + bus.error());
    devices->buses_.push_back(std::move(*bus));
    devices->clients_->AddToPump(devices->pumps_.emplace_back(*devices->buses_.back()), i);
  }
  if (params.plc) devices->plc_ = std::make_unique<PlcClient>(*params.plc);
  return devices;
}

control::CellReadings WiredDevices::Exchange(const control::CellCommands& commands,
                                             rt::Nanoseconds now) OSTEON_RT {
  clients_->Command(commands, now);
  for (CanPump& pump : pumps_) pump.Pump(now);
  const PlcReading& plc = plc_ ? plc_->Latest() : no_plc_;
  if (plc_) {
    plc_->NotifyAlive();
    plc_->RequestMotion(clients_->UpdateMotionRequest(commands, plc, now));
  }
  return clients_->Readings(plc, now);
}

std::string WiredDevices::Diagnosis() {
  return clients_->Diagnosis(plc_ ? plc_->Latest() : no_plc_, rt::MonotonicNow());
}

}  // namespace osteon::io
