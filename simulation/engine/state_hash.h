#pragma once

#include <string>

#include "simulation/engine/cutting_engine.h"

namespace osteon::simulation {

/// HashState as files and summaries keep it: 16 hexadecimal digits.
[[nodiscard]] std::string HashText(const CarvedState& state);

}  // namespace osteon::simulation
