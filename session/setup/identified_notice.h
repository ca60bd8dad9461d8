#pragma once

#include "config/reading/cell_config.h"

namespace osteon::session {

/// Prints on stderr the figures that a cell has from a file of `osteon identify` (IdentifiedText). Prints
/// nothing if the cell has no such file.
/// @param command  the subcommand that prints, such as "run"
void PrintIdentified(const config::CellConfig& cell, const char* command);

}  // namespace osteon::session
