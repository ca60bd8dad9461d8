#pragma once

#include <filesystem>
#include <string>

#include "session/run/live_views.h"

namespace osteon::app {

struct ViewOptions {
  std::filesystem::path recording;
  ConsoleChoice console{};
  std::filesystem::path
      json{};  ///< written once the page is served: {"url", "recording", "duration_s"}; empty: none
};

/// Runs `osteon view`: serves the console's page over a recording, with a time line, until Ctrl-C.
/// @returns the process's exit code: 0 after Ctrl-C; 1 the page could not be served; 2 no recording of this
/// program.
[[nodiscard]] int RunView(const ViewOptions& options);

}  // namespace osteon::app
