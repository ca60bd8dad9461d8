#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "io/can/ati_sensor.h"
#include "io/can/reamer_drive.h"
#include "io/can/robotous_sensor.h"
#include "io/modbus/plc_client.h"

namespace osteon::io {

/// A CAN bus of the cell.
struct CanBusParams {
  std::string name;              ///< name in the cell's file
  std::string interface;         ///< of SocketCAN, e.g. can0; empty: a UDP tunnel to a simulated cell
  std::uint16_t port{0};         ///< UDP port of our end of the tunnel, on the loopback
  std::uint16_t device_port{0};  ///< UDP port of the simulated devices' end
};

using WrenchSensorParams = std::variant<RobotousParams, AtiParams>;

/// The cell's devices beside the arm, and their buses.
struct DeviceParams {
  std::vector<CanBusParams> buses;
  WrenchSensorParams sensor;
  std::size_t sensor_bus{0};               ///< index in `buses`
  std::optional<ReamerDriveParams> drive;  ///< absent: the tool has no drive
  std::size_t drive_bus{0};                ///< index in `buses`
  std::optional<PlcClientParams> plc;
  rt::Nanoseconds plc_max_age{100 * rt::kMillisecond};  ///< of the PLC's block; twice that for its heartbeat
};

/// Checks the identifiers on each bus: text naming two devices of one bus that use the same identifier; empty
/// if there are none.
[[nodiscard]] std::optional<std::string> FindOverlap(const DeviceParams& params);

}  // namespace osteon::io
