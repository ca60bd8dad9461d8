#pragma once

#include <string>

namespace osteon::session {

/// Returns the commit from whose sources this program was built, with "-dirty" if they had uncommitted
/// changes.
[[nodiscard]] std::string CommitName();

/// Returns commit, compiler and C library of this program, in one line.
[[nodiscard]] std::string BuildName();

}  // namespace osteon::session
