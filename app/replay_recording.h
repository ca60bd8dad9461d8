#pragma once

#include <filesystem>

namespace osteon::app {

struct ReplayOptions {
  std::filesystem::path recording;
  std::filesystem::path cell;  ///< instead of the recorded configuration
  std::filesystem::path json;
};

/// `osteon replay`.
/// @returns the process's exit code: 0 every bit is the same; 1 one differs, or a tick could not be run
/// again; 2 the recording or the cell can not be read (said on stderr).
[[nodiscard]] int RunReplay(const ReplayOptions& options);

}  // namespace osteon::app
