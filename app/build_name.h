#pragma once

#include <string>

namespace osteon::app {

/// Commit, compiler and C library of this program, in one line.
[[nodiscard]] std::string BuildName();
/// Processor and kernel of this machine, in one line.
[[nodiscard]] std::string MachineName();

}  // namespace osteon::app
