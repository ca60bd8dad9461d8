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
  std::string name;       ///< name in the cell's file
  std::string interface;  ///< name of a SocketCAN interface, e.g. can0; empty: the bus is a UDP tunnel to a
                          ///< simulated cell
  std::uint16_t port{0};  ///< UDP port of the controller's end of the tunnel, on the loopback interface
  std::uint16_t device_port{0};  ///< UDP port of the simulated devices' end
};

using WrenchSensorParams = std::variant<RobotousParams, AtiParams>;

/// Parameters of the cell's devices other than the arm, and of their buses.
struct DeviceParams {
  std::vector<CanBusParams> buses;
  WrenchSensorParams sensor;
  std::size_t sensor_bus{0};               ///< index in `buses`
  std::optional<ReamerDriveParams> drive;  ///< absent: the tool has no drive
  std::size_t drive_bus{0};                ///< index in `buses`
  std::optional<PlcClientParams> plc;
  rt::Nanoseconds plc_max_age{100 * rt::kMillisecond};  ///< largest age of the PLC's block of registers;
                                                        ///< twice that for the last change of its heartbeat
};

/// Checks the identifiers on each bus. Returns a text that names two devices of one bus that use the same
/// identifier; empty if there are no such devices.
[[nodiscard]] std::optional<std::string> FindOverlap(const DeviceParams& params);

}  // namespace osteon::io
