#pragma once

#include "config/reading/cell_config.h"

namespace osteon::session {

/// Prints on stderr what a cell has of a file of `osteon identify` (IdentifiedText); nothing without one.
/// @param command  "run"
void PrintIdentified(const config::CellConfig& cell, const char* command);

}  // namespace osteon::session
