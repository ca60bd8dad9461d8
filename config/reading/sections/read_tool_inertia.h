#pragma once

#include "config/reading/strict/reader.h"
#include "control/sensing/hand_wrench.h"

namespace osteon::config {

/// Reads how the tool's inertia is compensated in the sensor's wrench, from the cell's `force_sensor`:
/// inertia_share_ratio and acceleration_hz. If they are absent, inertia is not compensated.
void ReadToolInertia(Reader& section, control::ForceSensorParams& sensor);

}  // namespace osteon::config
