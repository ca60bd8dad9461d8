#pragma once

#include "config/reader.h"
#include "control/servo_params.h"

namespace osteon::config {

/// The sections `age_governor`, `passivity` and `energy_tank` of a cell, as far as it has them; after its
/// law.
void ReadStabilisers(Reader& cell, control::Law law, control::StabiliserParams& stabilisers);

}  // namespace osteon::config
