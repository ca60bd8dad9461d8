#pragma once

#include <CLI/CLI.hpp>

#include "app/planned_cell.h"

namespace osteon::app {

/// The options --error-mm, --rate-hz and --as-packed, which `demo` and `run` have in common.
/// @param choice  what they say; must outlive the parsing
void AddFidelityOptions(CLI::App& app, FidelityChoice& choice);

}  // namespace osteon::app
