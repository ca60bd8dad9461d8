#pragma once

#include "config/reading/strict/reader.h"
#include "control/setup/servo_params.h"

namespace osteon::config {

/// Refuses values that are in their ranges but do not fit each other. The loop's constructor would refuse
/// them too (control::Validate, control::LawOf), but its error could not name file and line.
/// @throws ConfigError at the law's section, naming the parameter, the value and what is accepted.
void CheckLoop(const Reader& cell, const control::ServoParams& servo);

}  // namespace osteon::config
