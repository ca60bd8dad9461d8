#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// Says which file a subcommand's option would write over that must not be: one that another argument names,
/// a recording, a carved state, a session. Also an empty name, and a name of another kind of file. Empty:
/// none. Looks at `--json`, `--save-motion` and `--surface`. @param asked  the subcommand, parsed
[[nodiscard]] std::string ValidateOutputPaths(const CLI::App& asked);

}  // namespace osteon::app
