#pragma once

#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "control/ports.h"
#include "io/can/can_bus.h"
#include "io/can/can_pump.h"
#include "io/devices/device_clients.h"

namespace osteon::io {

/// The cell's devices in wall time. CAN buses are pumped once per tick; the PLC's client has its own thread.
/// Exchange() never waits. One thread at a time.
class WiredDevices final : public control::CellDevices {
 public:
  /// Opens the buses and starts the PLC's client. The devices may be switched on later. The error names bus
  /// or device, and says what to do.
  [[nodiscard]] static tl::expected<std::unique_ptr<WiredDevices>, std::string> Open(
      const DeviceParams& params);

  /// Sends the commands, and returns the newest readings of all devices. Call once per tick.
  [[nodiscard]] control::CellReadings Exchange(const control::CellCommands& commands,
                                               rt::Nanoseconds now) OSTEON_RT override;

  /// Returns what prevents the cell from moving; see DeviceClients::Diagnosis. Not for use in the tick.
  [[nodiscard]] std::string Diagnosis();

 private:
  WiredDevices() = default;

  std::unique_ptr<DeviceClients> clients_;
  std::vector<std::unique_ptr<CanBus>> buses_;
  std::vector<CanPump> pumps_;
  std::unique_ptr<PlcClient> plc_;
  PlcReading no_plc_;  // the reading of a cell without a PLC
};

}  // namespace osteon::io
