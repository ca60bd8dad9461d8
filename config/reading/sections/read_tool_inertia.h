#pragma once

#include "config/reading/strict/reader.h"
#include "control/sensing/hand_wrench.h"

namespace osteon::config {

/// Reads the tool's inertia from the cell's `force_sensor`: inertia_share_ratio and acceleration_hz; if
/// absent, inertia is not compensated.
void ReadToolInertia(Reader& section, control::ForceSensorParams& sensor);

}  // namespace osteon::config
