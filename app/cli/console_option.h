#pragma once

#include <CLI/CLI.hpp>

#include "session/run/live_views.h"

namespace osteon::app {

/// Adds `--console`: where a run serves its page.
void AddConsoleOption(CLI::App& sub, ConsoleChoice& choice);

}  // namespace osteon::app
