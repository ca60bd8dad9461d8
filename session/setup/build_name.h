#pragma once

#include <string>

namespace osteon::session {

/// Commit of the sources that this program was built from, with "-dirty" appended if they were not committed.
[[nodiscard]] std::string CommitName();

/// Commit, compiler and C library of this program, in one line.
[[nodiscard]] std::string BuildName();

}  // namespace osteon::session
