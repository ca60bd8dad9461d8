#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/failures/failure.h"
#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon failures`.
struct FailureOptions {
  std::vector<int> ids{};       ///< empty: every scenario
  std::filesystem::path out{};  ///< folder for failures.html and one picture per scenario; empty: none
  /// File for the page as Markdown, which shows the pictures of `out`; empty: none.
  std::filesystem::path markdown{};
  std::filesystem::path json{};  ///< empty: none
  std::string device{};          ///< part of a Vulkan device's name; empty: the best there is
  std::string engine{"auto"};    ///< "ours": one of EngineNames
  bool quick{false};             ///< computes with FailureSize::kTest: seconds instead of minutes
  std::string command_line{};    ///< the command that repeats the run
  Sharding sharding{};
};

/// One scenario and its result.
struct FailureRun {
  FailureResult result;
  double seconds{0.0};
  std::string error{};  ///< why the scenario ended without a result; empty: there is a result
  /// Whether the baseline failed and our method kept the bound.
  [[nodiscard]] bool passed() const { return error.empty() && result.baseline_fails && result.ours_passes; }
};

/// Runs the scenarios in which baseline methods fail, and prints a table.
/// @returns the process's exit code: 0 every baseline failed and our method kept every bound; 1 otherwise, or
/// a file could not be written; 2 wrong input, or no engine on this machine; 130 ended by Ctrl-C, with the
/// finished scenarios written.
[[nodiscard]] int RunFailures(const FailureOptions& options);

/// JSON object, schema osteon.failures/1.
[[nodiscard]] std::string FailuresJson(const std::vector<FailureRun>& runs, const std::string& engine,
                                       const std::string& device, bool quick);

}  // namespace osteon::studies
