#pragma once

#include <string>

#include "app/cli/help/command_table.h"

// The manual of the command in three forms, made from the description of the command line (command_table.h).

namespace osteon::app {

/// The manual page osteon(1) as roff, for man, groff and mandoc. ASCII only; other characters become escapes.
[[nodiscard]] std::string ManPage(const CommandText& command, const std::string& version);

/// The page docs/commands.md: a section for each subcommand.
[[nodiscard]] std::string CommandsPage(const CommandText& command);

/// The command line as JSON, of the schema osteon.manual/1.
[[nodiscard]] std::string ManualJson(const CommandText& command);

}  // namespace osteon::app
