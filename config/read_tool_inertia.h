#pragma once

#include "config/reader.h"
#include "control/hand_wrench.h"

namespace osteon::config {

/// What the cell's `force_sensor` says of the tool's inertia: inertia_share_ratio and acceleration_hz;
/// absent, nothing is made up for.
void ReadToolInertia(Reader& section, control::ForceSensorParams& sensor);

}  // namespace osteon::config
