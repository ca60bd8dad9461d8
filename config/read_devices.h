#pragma once

#include <vector>

#include "config/cell_config.h"
#include "config/reader.h"

namespace osteon::config {

/// The cell's devices as its file names them; what the tool says of its drive comes later (CompleteDevices).
struct DeviceSections {
  Reader cell, force_sensor;
};

/// Sections `can`, `force_sensor` (its bus, make and pose), `plc`, and `drive` where there is one: both sides
/// of each wire.
void ReadDevices(const DeviceSections& sections, CellConfig& cell);

/// After Finish() and with the tool loaded: its drive's figures, the sensor's load, and what of the buses
/// only shows together. Refuses devices that use the same identifiers.
void CompleteDevices(const DeviceSections& sections, CellConfig& cell);

}  // namespace osteon::config
