#pragma once

#include <string>

#include "app/cli/help/command_table.h"

// Scripts by which a shell completes the command line: subcommands, options, accepted words, files, and names
// below config/. A script contains all these words, so completing a word starts no process.

namespace osteon::app {

[[nodiscard]] std::string BashCompletion(const CommandText& command);
[[nodiscard]] std::string ZshCompletion(const CommandText& command);
[[nodiscard]] std::string FishCompletion(const CommandText& command);

}  // namespace osteon::app
