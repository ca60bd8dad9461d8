#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// Checks the files that `--json`, `--save-motion` and `--surface` would write. Refuses a file that another
/// argument names, an existing recording, carved state or session, and a name with the ending of another kind
/// of file. Also refuses an empty name in any option for a file or folder.
/// @param asked  the subcommand, parsed  @returns what was found and what is accepted; empty: nothing is
/// wrong
[[nodiscard]] std::string ValidateOutputPaths(const CLI::App& asked);

}  // namespace osteon::app
