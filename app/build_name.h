#pragma once

#include <string>

namespace osteon::app {

/// Commit, compiler and C library of this program, in one line.
[[nodiscard]] std::string BuildName();

}  // namespace osteon::app
