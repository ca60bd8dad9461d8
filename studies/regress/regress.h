#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "config/reading/scenario_config.h"
#include "studies/regress/golden_file.h"
#include "studies/regress/scenario_run.h"
#include "studies/regress/trace_diff.h"
#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Command line of `osteon regress`.
struct RegressOptions {
  std::filesystem::path config_root;
  std::vector<std::string> scenarios;  ///< files, folders, or names under scenarios/; none: all of scenarios/
  std::filesystem::path out{"regress_out"};  ///< folder for the page of differences
  std::filesystem::path json, junit;         ///< empty: none
  bool update{false};                        ///< true: the run becomes the golden trace if it differs
  std::string reason;                        ///< why new traces are accepted
  bool all{false};                           ///< permits an update without named scenarios: all are updated
  bool exact{false};                         ///< true: any differing bit is a failure
  int jobs{0};                               ///< number of scenarios in parallel; 0: one per core
  std::string device;                        ///< part of a Vulkan device's name; empty: the default device
  std::vector<std::string> set;              ///< KEY=VALUE, overrides every scenario's cell
  std::string command_line;
  Sharding sharding{};
};

/// The outcome of one scenario.
struct RegressResult {
  config::ScenarioConfig scenario;
  std::string error;  ///< why there is no run, or no golden trace to compare with; empty: there are both
  std::optional<ScenarioRun> run;
  std::optional<Golden> golden;  ///< the golden trace as it was before an update
  TraceDifference difference;    ///< valid if there are both a run and a golden trace
  /// Explanation of a difference in a few lines, the most informative first; empty if all bits are the same.
  std::vector<std::string> explained;
  bool updated{false};  ///< this run has replaced the golden trace

  /// @param exact  true: any differing bit is a failure
  [[nodiscard]] bool Passed(bool exact) const;
  [[nodiscard]] bool identical() const { return error.empty() && difference.identical; }
};

/// Finds the files of the named scenarios; if none is named, the files of all scenarios, sorted by name.
/// @returns the files, or an error that lists the available scenarios.
[[nodiscard]] tl::expected<std::vector<std::filesystem::path>, std::string> FindScenarios(
    const std::filesystem::path& config_root, const std::vector<std::string>& asked);

/// Runs a scenario and compares it with its golden trace. Writes nothing.
[[nodiscard]] RegressResult RunAndCompare(const config::ScenarioConfig& scenario,
                                          const ScenarioRunParams& params);

/// Runs `osteon regress`.
/// @returns the process's exit code: 0 all passed; 1 at least one failed; 2 wrong options or files (said on
/// stderr); 130 Ctrl-C.
[[nodiscard]] int RunRegress(const RegressOptions& options);

}  // namespace osteon::studies
