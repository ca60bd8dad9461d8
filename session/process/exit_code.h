#pragma once

#include <exception>
#include <string>
#include <string_view>

// Exit codes of a subcommand's process; 0 means done.

namespace osteon::session {

constexpr int kFailed = 1;    // the requested work failed: a scenario, a check
constexpr int kBadInput = 2;  // wrong usage or bad input
// A defect of this program or of a library or system that it uses; sysexits.h: EX_SOFTWARE.
constexpr int kInternalError = 70;
constexpr int kNoMemory = 71;  // sysexits.h: EX_OSERR

/// Prints "osteon COMMAND: MESSAGE", one line, to stderr, with control characters made
/// visible. @returns `code`
int Fail(std::string_view command, std::string_view message, int code = kBadInput);

/// The exit code and the message for an exception that was not handled.
struct Failure {
  int code{kInternalError};
  std::string text;
};

/// Translates an exception. Errors of configuration, parameter or path give kBadInput; lack of memory gives
/// kNoMemory; all others give kInternalError, and the text says so.
[[nodiscard]] Failure Explain(const std::exception& error);

}  // namespace osteon::session
