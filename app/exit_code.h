#pragma once

#include <exception>
#include <string>
#include <string_view>

// What a subcommand's process ends with. 0: done.

namespace osteon::app {

constexpr int kFailed = 1;          // what was asked for failed: a scenario, a check
constexpr int kBadInput = 2;        // wrong usage or bad input
constexpr int kInternalError = 70;  // a defect of this program or of what it runs on; sysexits.h: EX_SOFTWARE
constexpr int kNoMemory = 71;       // sysexits.h: EX_OSERR

/// Prints "osteon COMMAND: MESSAGE", one line, to stderr. @returns code.
int Fail(std::string_view command, std::string_view message, int code = kBadInput);

/// What an exception that nobody handled means.
struct Failure {
  int code{kInternalError};
  std::string text;
};

/// Of the configuration, of a parameter, of a path: bad input. Without memory: kNoMemory. Else: an internal
/// error, whose text says so.
[[nodiscard]] Failure Explain(const std::exception& error);

}  // namespace osteon::app
