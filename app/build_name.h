#pragma once

#include <string>

namespace osteon::app {

/// Of the sources that this program was built from; with "-dirty" behind it where they were not committed.
[[nodiscard]] std::string CommitName();

/// Commit, compiler and C library of this program, in one line.
[[nodiscard]] std::string BuildName();

}  // namespace osteon::app
