#pragma once

#include <string>

#include "simulation/engine/cutting_engine.h"

namespace osteon::simulation {

/// Formats HashState for files and summaries: 16 hexadecimal digits.
[[nodiscard]] std::string HashText(const CarvedState& state);

}  // namespace osteon::simulation
