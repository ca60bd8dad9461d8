#pragma once

#include <filesystem>

namespace osteon::session {

/// The options of `osteon replay`.
struct ReplayOptions {
  std::filesystem::path recording;
  std::filesystem::path cell;  ///< replaces the recorded configuration
  std::filesystem::path json;  ///< file for the result; empty: none
};

/// Runs `osteon replay`.
/// @returns the process's exit code: 0 every bit is the same; 1 one differs, or a tick could not be replayed;
/// 2 the recording or the cell cannot be read (said on stderr).
[[nodiscard]] int RunReplay(const ReplayOptions& options);

}  // namespace osteon::session
