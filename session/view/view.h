#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "session/run/live_views.h"

namespace osteon::session {

struct ViewOptions {
  /// One recording, or two that are shown side by side.
  std::vector<std::filesystem::path> recordings;
  double at_s{0.0};  ///< the time that is shown at first
  ConsoleChoice console{};
  /// File that is written once the page is served: {"url", "recording", "duration_s", "second"}; empty: none.
  std::filesystem::path json{};
};

/// Runs `osteon view`: serves the console's page over a recording, or over two side by side with their
/// difference, with a time line, until Ctrl-C.
/// @returns the process's exit code: 0 after Ctrl-C; 1 the page could not be served; 2 a file is no recording
/// of this program.
[[nodiscard]] int RunView(const ViewOptions& options);

}  // namespace osteon::session
