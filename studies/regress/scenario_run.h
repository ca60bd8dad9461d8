#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "base/work_folder.h"
#include "config/reading/scenario_config.h"
#include "studies/regress/golden_file.h"
#include "studies/regress/scenario_trace.h"

namespace osteon::studies {

/// Settings of a run that are not part of its scenario.
struct ScenarioRunParams {
  std::string device{};  ///< part of a Vulkan device's name; empty: the default device
  /// Assignments KEY=VALUE that override values of every scenario's cell (Overlay::Set).
  std::vector<std::string> set{};
  const std::atomic<bool>* stop{nullptr};
  /// Time for which the arm is still recorded after it has come to rest. 0: the trace ends with the last
  /// commanded motion, although the measured arm completes this motion about 0.1 s later.
  double at_rest_s{0.0};
  /// Folder in which the recordings (NAME.mcap) of those runs are kept that are not bit-identical with their
  /// golden traces; empty: they are not kept.
  std::filesystem::path keep_in{};
};

/// The greatest values of a run while the loop rendered.
struct RunFigures {
  double peak_force_N{0.0};              ///< rendered, after all limits
  double peak_hand_force_N{0.0};         ///< measured by the sensor
  double peak_tool_in_bone_mm{0.0};      ///< distance from the tool to its collision-free pose
  double peak_tool_speed_mm_per_s{0.0};  ///< commanded
  double removed_mm3{0.0};               ///< volume of bone removed in the whole run
  /// Cutting debt at the end: work for cleared bone that the edge has not yet done; negative: work done for
  /// bone that is not yet cleared.
  double cutting_debt_J{0.0};
};

/// The result of a run.
struct ScenarioRun {
  ScenarioTrace trace;
  RunFigures figures{};
  std::vector<GoldenSource> sources;  ///< the files that the run was made from
  std::string engine;                 ///< "reference on CPU, double precision"
  /// Temporary folder of the recording; it is removed with the last copy of this pointer.
  std::shared_ptr<const base::WorkFolder> folder;
  std::filesystem::path recording;
  double seconds_simulated{0.0};  ///< total virtual time
  double seconds_wall{0.0};       ///< total wall time
  double seconds_cpu{0.0};        ///< CPU time of the run's thread; less than the wall time on a busy machine
  double seconds_set_up{0.0};     ///< wall time of the set-up: reading files, packing bone
};

/// Reads a scenario's cell with the overrides, without running anything, so that errors are found early.
/// @throws config::ConfigError
void CheckScenario(const config::ScenarioConfig& scenario, const ScenarioRunParams& params);

/// Runs a scenario in virtual time, in the calling thread, with its recording in a temporary folder. Two runs
/// give equal bits, whatever else the machine does.
/// @returns an error if the cell cannot be set up or run.
[[nodiscard]] tl::expected<ScenarioRun, std::string> RunScenario(const config::ScenarioConfig& scenario,
                                                                 const ScenarioRunParams& params);

/// Names the files that changed since the golden trace was made.
[[nodiscard]] std::vector<std::string> ChangedSources(const std::vector<GoldenSource>& golden,
                                                      const std::vector<GoldenSource>& now);

}  // namespace osteon::studies
