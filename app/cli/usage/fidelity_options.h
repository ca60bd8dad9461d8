#pragma once

#include <CLI/CLI.hpp>

#include "session/planning/planned_cell.h"

namespace osteon::app {

/// Adds the options --error-mm, --rate-hz and --as-packed, which `demo` and `run` share.
/// @param choice  receives their values; must outlive the parsing
void AddFidelityOptions(CLI::App& app, session::FidelityChoice& choice);

}  // namespace osteon::app
