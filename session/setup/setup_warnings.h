#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"

namespace osteon::session {

/// Returns a sentence for each thing that a cell's file asks for and the cell cannot provide. Screen, summary
/// and verdict show these sentences.
/// @param real  a person operates the cell, not a script
[[nodiscard]] std::vector<std::string> SetupWarnings(const config::CellConfig& cell, bool real);

}  // namespace osteon::session
