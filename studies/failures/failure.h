#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/tools/tool.h"

// Scenarios in which methods fail. Each scenario has a baseline method that fails in it, and a bound that our
// method ("ours") must keep. Its function is `FailureResult Run<Name>(const FailureSetting&)`;
// failure_list.cpp lists them all.

namespace osteon::studies {

/// One line of a scenario's picture.
struct FailureSeries {
  std::string name{};
  std::vector<double> x{}, y{};  ///< of the same length
  bool ours{false};              ///< a line of our method; false: of the baseline, or common to both
};

/// A scenario's picture: the data behind the metric.
struct FailurePlot {
  std::string x_label{}, y_label{};  ///< with units
  bool log_x{false}, log_y{false};
  std::vector<FailureSeries> series{};
  bool bound_is_on_y{false};  ///< y is the metric: the bound is drawn as a line
};

/// Result of a scenario, which sets `baseline_fails` and `ours_passes` from the same metric.
struct FailureResult {
  int id{0};
  std::string name{};            ///< "thin sheet"
  std::string metric{}, unit{};  ///< "shots that passed through", "1"
  std::string baseline_name{};   ///< description of the baseline: "pointshell, voxels of 0.25 mm"
  double bound{0.0}, baseline{0.0}, ours{0.0};
  bool baseline_fails{false}, ours_passes{false};
  /// One or two sentences with other observations, such as secondary figures and counts; may be empty.
  std::string note{};
  FailurePlot plot{};
};

/// Makes the engine of our method: the reference engine, or an engine that this folder must not depend on.
/// May throw; the scenario then ends with that exception.
using EngineFactory = std::function<std::unique_ptr<simulation::CuttingEngine>(
    const simulation::Bone&, const simulation::Tool&, const Pose& X_WG, const simulation::CuttingParams&)>;

/// Amount of computation. kTest: a few seconds on one core with the reference engine. kFull: the extent that
/// failures.md requires.
enum class FailureSize : std::uint8_t { kTest, kFull };

/// The engine, amount of computation and progress report of a scenario's run.
struct FailureSetting {
  EngineFactory make_engine;  ///< "ours"
  FailureSize size{FailureSize::kTest};
  /// Called now and then with the share that is done, 0 … 1; may be empty. If it returns false, the scenario
  /// stops early and returns its results so far, marked as not passed.
  std::function<bool(double)> progress{};

  [[nodiscard]] bool full() const { return size == FailureSize::kFull; }
  [[nodiscard]] bool GoesOn(double share) const { return !progress || progress(share); }
};

/// An entry of the list of scenarios.
struct FailureScenario {
  int id{0};
  std::string name;
  FailureResult (*run)(const FailureSetting&){nullptr};
};

/// Every scenario, by ascending number.
[[nodiscard]] std::span<const FailureScenario> FailureScenarios();

}  // namespace osteon::studies
