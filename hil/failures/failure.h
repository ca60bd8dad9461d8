#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "simulation/bone.h"
#include "simulation/cutting_engine.h"
#include "simulation/tool.h"

// Where methods fail: each scenario is a generator, a baseline that is seen to fail in it, and a bound that
// ours must keep. One file a scenario, `FailureResult Run<Name>(const FailureSetting&)`; failure_list.cpp has
// them all.

namespace osteon::hil {

/// One line of a scenario's picture.
struct FailureSeries {
  std::string name{};
  std::vector<double> x{}, y{};  ///< of the same length
  bool ours{false};              ///< else the baseline's, or what is common to both
};

/// A scenario's picture: what the metric came from.
struct FailurePlot {
  std::string x_label{}, y_label{};  ///< with units
  bool log_x{false}, log_y{false};
  std::vector<FailureSeries> series{};
  bool bound_is_on_y{false};  ///< the metric is y's: the bound is drawn as a line
};

/// What came out. `baseline_fails` and `ours_passes` are judged by the scenario, from the same metric.
struct FailureResult {
  int id{0};
  std::string name{};            ///< "thin sheet"
  std::string metric{}, unit{};  ///< "shots that passed through", "1"
  std::string baseline_name{};   ///< what the baseline is: "pointshell, voxels of .25 mm"
  double bound{0.0}, baseline{0.0}, ours{0.0};
  bool baseline_fails{false}, ours_passes{false};
  std::string note{};  ///< what else was seen: secondary figures, counts; empty or one sentence or two
  FailurePlot plot{};
};

/// Makes "ours": the reference engine, or an engine that this folder must not know. May throw: then the
/// scenario ends with that exception.
using EngineFactory = std::function<std::unique_ptr<simulation::CuttingEngine>(
    const simulation::Bone&, const simulation::Tool&, const Pose& X_WG, const simulation::CuttingParams&)>;

/// How much is computed: kTest is a few seconds of one core on the reference engine, kFull what failures.md
/// asks.
enum class FailureSize : std::uint8_t { kTest, kFull };

struct FailureSetting {
  EngineFactory make_engine;  ///< "ours"
  FailureSize size{FailureSize::kTest};
  /// Told the share that is done, 0 … 1, now and then; may be empty. Returns false to stop early: the
  /// scenario then returns what it has, marked as not passed.
  std::function<bool(double)> progress{};

  [[nodiscard]] bool full() const { return size == FailureSize::kFull; }
  [[nodiscard]] bool GoesOn(double share) const { return !progress || progress(share); }
};

struct FailureScenario {
  int id{0};
  std::string name;
  FailureResult (*run)(const FailureSetting&){nullptr};
};

/// Every scenario, by ascending number.
[[nodiscard]] std::span<const FailureScenario> FailureScenarios();

}  // namespace osteon::hil
