#include "session/setup/build_name.h"

#include <unistd.h>

#include <array>

#include <fmt/format.h>

#include "session/commit.h"

namespace osteon::session {

std::string CommitName() { return kCommit; }

std::string BuildName() {
  std::array<char, 64> library{};
  confstr(_CS_GNU_LIBC_VERSION, library.data(), library.size());
  return fmt::format("commit {}, gcc {}, {}", kCommit, __VERSION__, library.data());
}

}  // namespace osteon::session
