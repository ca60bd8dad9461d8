#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/golden_file.h"
#include "app/scenario_run.h"
#include "app/trace_diff.h"
#include "config/scenario_config.h"

namespace osteon::app {

struct RegressOptions {
  std::filesystem::path config_root;
  std::vector<std::string> scenarios;  ///< files, folders, or names under scenarios/; none: all of scenarios/
  std::filesystem::path out{"regress_out"};  ///< for the page of what differs
  std::filesystem::path json, junit;
  bool update{false};
  std::string reason;            ///< of the update
  bool all{false};               ///< the update is of all scenarios, though none is named
  bool exact{false};             ///< a bit that differs fails
  int jobs{0};                   ///< scenarios at a time; 0: one a core
  std::string device;            ///< part of a Vulkan device's name
  std::vector<std::string> set;  ///< KEY=VALUE, laid over every scenario's cell
  std::string command_line;
};

/// What became of a scenario.
struct RegressResult {
  config::ScenarioConfig scenario;
  std::string error;  ///< why there is no run, or no golden trace to hold it against; empty: there are both
  std::optional<ScenarioRun> run;
  std::optional<Golden> golden;  ///< as it was before
  TraceDifference difference;    ///< with both
  std::vector<std::string>
      explained;        ///< a few lines, the most telling first; empty where every bit is the same
  bool updated{false};  ///< its golden trace is this run's now

  /// @param exact  a bit that differs fails
  [[nodiscard]] bool Passed(bool exact) const;
  [[nodiscard]] bool identical() const { return error.empty() && difference.identical; }
};

/// Finds the scenarios that were asked for, in the order of their names where all were.
/// @returns an error that says what there is.
[[nodiscard]] tl::expected<std::vector<std::filesystem::path>, std::string> FindScenarios(
    const std::filesystem::path& config_root, const std::vector<std::string>& asked);

/// Runs a scenario and holds it against its golden trace. Nothing is written.
[[nodiscard]] RegressResult RunAndCompare(const config::ScenarioConfig& scenario,
                                          const ScenarioRunParams& params);

/// `osteon regress`.
/// @returns the process's exit code: 0 all passed; 1 one did not; 2 wrong options or files (said on stderr);
/// 130 Ctrl-C.
[[nodiscard]] int RunRegress(const RegressOptions& options);

}  // namespace osteon::app
