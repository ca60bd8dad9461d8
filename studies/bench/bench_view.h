#pragma once

#include <filesystem>

namespace osteon::studies {

/// Options of `osteon bench view`.
struct BenchViewOptions {
  std::filesystem::path recording;
  double hours{1.0};
  int seeks{20};
  /// Folder of the long recording, which is removed afterwards; empty: a temporary one.
  std::filesystem::path folder{};
  std::filesystem::path json{};
};

/// Repeats a recording until it is `hours` long, opens it as `osteon view` does, and measures three times:
/// the time until ticks and bone are shown, the time until the bone's key states are complete, and the time
/// of seeks all over the recording, each until its tick and its bone are shown.
/// @returns the process's exit code: 0; 1 if a file could not be written, or one of these never happened; 2
/// bad input.
[[nodiscard]] int RunBenchView(const BenchViewOptions& options);

}  // namespace osteon::studies
