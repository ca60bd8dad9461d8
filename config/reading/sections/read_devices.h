#pragma once

#include <optional>
#include <string>

#include "config/reading/cell_config.h"
#include "config/reading/strict/reader.h"

namespace osteon::config {

/// A device's section, and the bus that it names.
struct DeviceBus {
  Reader section;
  std::string name;
};

/// Sections and values of the file that CompleteDevices needs.
struct DeviceSections {
  Reader cell;
  DeviceBus sensor;
  std::optional<DeviceBus> drive;
  bool without_plc{false};  ///< the file contains without_plc: accepted
};

/// Reads sections `can`, `force_sensor` (its bus, make and pose), `plc` or `without_plc`, and `drive` if
/// there is one, for the loop's drivers and for the simulated devices.
[[nodiscard]] DeviceSections ReadDevices(Reader& cell_section, Reader& force_sensor, CellConfig& cell);

/// Call after Finish() and after the tool is loaded. Computes the drive's limits and the sensor's load from
/// the tool, and checks the buses. Refuses an unknown bus, two devices with the same CAN identifiers, and a
/// cell with neither `plc` nor `without_plc`.
void CompleteDevices(const DeviceSections& sections, CellConfig& cell);

}  // namespace osteon::config
