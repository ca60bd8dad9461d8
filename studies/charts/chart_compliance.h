#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "session/summary/verdict.h"
#include "studies/bench/level_cost.h"

namespace osteon::studies {

/// Options of `osteon chart compliance`. The chart shows for each compliant level (tool, surface layer, bone
/// mount) its cost in the loop's time, and its effect on the stiffness that the hand feels.
struct ComplianceChartOptions {
  std::filesystem::path config_root;
  std::filesystem::path out{"compliance"};
  std::size_t ticks{2000};       ///< timed with each level
  std::filesystem::path json{};  ///< a second copy
};

/// The effect of one compliant level in a shipped cell, computed with the cell's own coupling and compliance
/// elements.
struct LevelChange {
  std::string name, cell;
  double stiffness_N_per_m{0.0};  ///< stiffness of the coupling
  double error_m{0.0};            ///< displacement that the cell reports
  /// Displacement at rest under each force, up to where the cell stops.
  std::vector<double> force_N{}, gives_m{};
  /// Stiffness that the hand feels in a small motion about a constant push, divided by the coupling's
  /// stiffness, at each frequency.
  std::vector<double> hz{}, felt_ratio{};
};

/// Computes the effect of the cell's level: of a tool across its feed, of a layer or mount along the feed.
/// The result's `cell` stays empty.
/// @throws std::invalid_argument unless the cell has exactly one compliant level
[[nodiscard]] LevelChange ChangeOf(const config::CellConfig& cell, const std::string& name);

/// The result of `osteon chart compliance`.
struct ComplianceChart {
  std::string machine;
  std::size_t ticks{0};
  std::vector<LevelCost> costs;      ///< for cells/demo.yaml; the first entry is without any level
  std::vector<LevelChange> changes;  ///< one for each level
};

/// "bad" if a tick allocated memory; "look" if all levels together add more than 3 us to the loop's median.
[[nodiscard]] session::Verdict Judge(const ComplianceChart& chart);

/// @returns the process's exit code: 0; 1 if it can't run here; 2 bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunChartCompliance(const ComplianceChartOptions& options);

}  // namespace osteon::studies
