#pragma once

#include <string_view>

// What a subcommand's process ends with. 0: done.

namespace osteon::app {

constexpr int kFailed = 1;    // what was asked for failed: a scenario, a check
constexpr int kBadInput = 2;  // wrong usage or bad input

/// Prints "osteon COMMAND: MESSAGE", one line, to stderr. @returns code.
int Fail(std::string_view command, std::string_view message, int code = kBadInput);

}  // namespace osteon::app
