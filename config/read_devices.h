#pragma once

#include <optional>
#include <string>

#include "config/cell_config.h"
#include "config/reader.h"

namespace osteon::config {

/// A device's section, and the bus that it names.
struct DeviceBus {
  Reader section;
  std::string name;
};

/// What CompleteDevices needs of the file.
struct DeviceSections {
  Reader cell;
  DeviceBus sensor;
  std::optional<DeviceBus> drive;
  bool without_plc{false};  ///< the file says without_plc: accepted
};

/// Sections `can`, `force_sensor` (its bus, make and pose), `plc` or `without_plc`, and `drive` where there
/// is one: both sides of each wire.
[[nodiscard]] DeviceSections ReadDevices(Reader& cell_section, Reader& force_sensor, CellConfig& cell);

/// After Finish() and with the tool loaded: its drive's figures, the sensor's load, and what of the buses
/// only shows together. Refuses a bus that there is not, devices that use the same identifiers, and a cell
/// that has no PLC and does not say so.
void CompleteDevices(const DeviceSections& sections, CellConfig& cell);

}  // namespace osteon::config
