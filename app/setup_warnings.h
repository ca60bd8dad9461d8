#pragma once

#include <string>
#include <vector>

#include "config/cell_config.h"

namespace osteon::app {

/// What a cell asks for and can't have, found before it runs: sentences for the screen, the summary and its
/// verdict.
/// @param real  there is no scripted hand
[[nodiscard]] std::vector<std::string> SetupWarnings(const config::CellConfig& cell, bool real);

}  // namespace osteon::app
