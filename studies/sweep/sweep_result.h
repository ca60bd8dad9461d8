#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "config/reading/sweep_config.h"
#include "studies/regress/scenario_run.h"
#include "studies/sweep/sweep_run.h"

namespace osteon::studies {

/// The outcome of a run.
struct SweepOutcome {
  SweepRun run{};
  std::string error{};                ///< why there are no figures; empty: there are figures
  std::string ended{};                ///< how the run ended
  std::vector<std::string> faults{};  ///< names, in the order in which they occurred
  std::string hash{};                 ///< hash over every bit of every tick
  RunFigures figures{};
};

/// A sweep with the outcomes of its runs.
struct SweepResult {
  config::SweepConfig config;
  std::string scenario;
  std::vector<SweepOutcome> outcomes{};  ///< in the order of the runs: all of them, or those of a shard
};

/// A figure of a run; its name ends in its unit.
struct SweepFigure {
  std::string_view name, label;
  double RunFigures::*value;
};
inline constexpr std::array kSweepFigures{
    SweepFigure{"peak_force_N", "peak force [N]", &RunFigures::peak_force_N},
    SweepFigure{"peak_hand_force_N", "peak force of the hand [N]", &RunFigures::peak_hand_force_N},
    SweepFigure{"peak_tool_in_bone_mm", "deepest tool in bone [mm]", &RunFigures::peak_tool_in_bone_mm},
    SweepFigure{"peak_tool_speed_mm_per_s", "peak tool speed [mm/s]", &RunFigures::peak_tool_speed_mm_per_s},
    SweepFigure{"removed_mm3", "bone removed [mm³]", &RunFigures::removed_mm3}};

/// Quantiles, by the nearest-rank method.
struct Quantiles {
  double min{0.0}, p05{0.0}, median{0.0}, p95{0.0}, max{0.0};
};
/// @returns zeros if there is no value.
[[nodiscard]] Quantiles QuantilesOf(std::vector<double> values);

/// The values of a figure, from all outcomes that have figures.
[[nodiscard]] std::vector<double> ValuesOf(std::span<const SweepOutcome> outcomes, const SweepFigure& figure);

/// Converts an outcome to a JSON item of a part file (studies/sharding).
[[nodiscard]] nlohmann::json SweepItem(const SweepOutcome& outcome);
/// Converts an item back. @throws nlohmann::json::exception or std::invalid_argument if the item is damaged.
[[nodiscard]] SweepOutcome SweepOutcomeFrom(const nlohmann::json& item, const config::SweepConfig& sweep,
                                            std::size_t index);

/// Text for the terminal: a line for each combination, then a line for each run that could not be made.
[[nodiscard]] std::string SweepTable(const SweepResult& result);
/// JSON, schema osteon.sweep/1. It contains no computing times, so two runs of a sweep give the same text.
[[nodiscard]] std::string SweepJson(const SweepResult& result);
/// CSV: a line for each run.
[[nodiscard]] std::string SweepCsv(const SweepResult& result);

/// The outcomes of a whole sweep, grouped: one span for each combination, in the order of the combinations.
[[nodiscard]] std::vector<std::span<const SweepOutcome>> ByCombination(const SweepResult& result);
/// The values by which a combination differs from the others: "stiffness_N_per_mm 10, tremor_N drawn".
[[nodiscard]] std::string NameOfCombination(const SweepResult& result, const SweepOutcome& outcome);

}  // namespace osteon::studies
