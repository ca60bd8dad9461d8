#pragma once

#include "config/reading/strict/reader.h"
#include "control/sensing/hand_wrench.h"

namespace osteon::config {

/// Reads the compensation of the tool's inertia in the sensor's wrench: keys inertia_share_ratio and
/// acceleration_hz of the cell's `force_sensor`. If the keys are absent, inertia is not compensated.
void ReadToolInertia(Reader& section, control::ForceSensorParams& sensor);

}  // namespace osteon::config
