#pragma once

#include <string>

#include "app/cli/help/command_table.h"

// Scripts by which a shell completes the command: subcommands, options, words, files, and names below
// config/. A script contains all of its words: completing one starts no process.

namespace osteon::app {

[[nodiscard]] std::string BashCompletion(const CommandText& command);
[[nodiscard]] std::string ZshCompletion(const CommandText& command);
[[nodiscard]] std::string FishCompletion(const CommandText& command);

}  // namespace osteon::app
