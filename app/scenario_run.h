#pragma once

#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "app/golden_file.h"
#include "app/scenario_trace.h"
#include "config/scenario_config.h"

namespace osteon::app {

/// What is run beside what a scenario says.
struct ScenarioRunParams {
  std::string device{};            ///< part of a Vulkan device's name
  std::vector<std::string> set{};  ///< KEY=VALUE each, laid over every scenario's cell (Overlay::Lay)
  const std::atomic<bool>* stop{nullptr};
};

struct ScenarioRun {
  ScenarioTrace trace;
  std::vector<GoldenSource> sources;  ///< the files that it was made from
  std::string engine;                 ///< "reference on CPU, double precision"
  double seconds_simulated{0.0};      ///< of virtual time, all of it
  double seconds_wall{0.0};           ///< that all of it took
  double seconds_cpu{0.0};            ///< that its thread had a core meanwhile: on a busy machine less
  double seconds_set_up{0.0};         ///< wall time until it ran: reading files, packing bone
};

/// Reads a scenario's cell with what is laid over it, and runs nothing: what is wrong in it is known before
/// any run.
/// @throws config::ConfigError
void CheckScenario(const config::ScenarioConfig& scenario, const ScenarioRunParams& params);

/// Runs it in virtual time, in the calling thread; its recording lies in a temporary folder meanwhile. Two
/// runs give equal bits, whatever runs beside them.
/// @returns an error where the cell refuses to be set up or to run.
[[nodiscard]] tl::expected<ScenarioRun, std::string> RunScenario(const config::ScenarioConfig& scenario,
                                                                 const ScenarioRunParams& params);

/// How its golden trace compares: files that changed since, by name.
[[nodiscard]] std::vector<std::string> ChangedSources(const std::vector<GoldenSource>& golden,
                                                      const std::vector<GoldenSource>& now);

}  // namespace osteon::app
