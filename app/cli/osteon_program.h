#pragma once

namespace osteon::app {

/// The whole of the command `osteon`: reads the command line and calls a subcommand.
/// @returns the process's exit code: 0 done, 1 the requested work failed, 2 wrong usage or bad input, 70 an
///   internal error, 71 out of memory, 130 ended by Ctrl-C, 129 by SIGHUP, 141 because nobody reads the
///   output.
[[nodiscard]] int RunOsteon(int argc, char** argv);

}  // namespace osteon::app
