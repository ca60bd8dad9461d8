#pragma once

#include <string>
#include <vector>

#include "config/reading/cell_config.h"

namespace osteon::app {

/// Finds, before a run, what a cell asks for and can't have: sentences for the screen, the summary and its
/// verdict.
/// @param real  the cell has a real hand, no scripted one
[[nodiscard]] std::vector<std::string> SetupWarnings(const config::CellConfig& cell, bool real);

}  // namespace osteon::app
