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

/// Repeats a recording until it has the length, opens it as `osteon view` does, and times: until ticks and
/// bone are there, until the bone's key states are complete, and seeks to places all over it, each until its
/// tick and its bone are shown.
/// @returns the process's exit code: 0; 1 if something could not be written or did not come; 2 bad input.
[[nodiscard]] int RunBenchView(const BenchViewOptions& options);

}  // namespace osteon::studies
