#pragma once

#include "config/reading/strict/reader.h"
#include "control/setup/servo_params.h"

namespace osteon::config {

/// Reads a cell's optional sections `age_governor`, `passivity` and `energy_tank`. Call after the law is
/// read.
void ReadStabilisers(Reader& cell, control::Law law, control::StabiliserParams& stabilisers);

}  // namespace osteon::config
