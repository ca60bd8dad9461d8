#pragma once

#include "config/reading/strict/reader.h"
#include "control/setup/servo_params.h"

namespace osteon::config {

/// Refuses here, where the file is known, what the loop's constructor would refuse (control::Validate,
/// control::LawOf): values that are in their ranges but do not fit each other.
/// @throws ConfigError at the law's section, naming the parameter, the value and what is accepted.
void CheckLoop(const Reader& cell, const control::ServoParams& servo);

}  // namespace osteon::config
