#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "control/compliance/compliance.h"
#include "simulation/fidelity/frame_workload.h"
#include "studies/bench/tick_bench.h"

namespace osteon::studies {

/// What gives way in a timed cell, by a name.
struct NamedLevels {
  std::string name;
  control::ComplianceParams params;
};

/// off, tool, layer, mount, all: of the demo's cell with its reamer, its cartilage, and a mount of 12 kg and
/// 10 Hz that is 80 mm below the cup.
/// @throws std::invalid_argument where the cell's tool or scene does not say how it gives way.
[[nodiscard]] std::vector<NamedLevels> LevelsOf(const config::CellConfig& cell);

/// What a tick takes while a level gives way.
struct LevelCost {
  std::string name;
  simulation::TimeFigures tick, loop;  ///< the whole tick; the servo loop alone
  int allocations{0};
  double force_N{0.0};  ///< mean coupling force
  double guided{0.0};   ///< share of the ticks in which guidance acts
  bool realtime{false};
};

/// Times the tick of cells/demo.yaml with each of LevelsOf, tick by tick in turn in one run. On Ctrl-C the
/// figures are of the ticks so far.
/// @throws std::runtime_error if a level's tool did not press in so many ticks; std::invalid_argument as
/// BenchCell.
[[nodiscard]] std::vector<LevelCost> TimeLevels(const std::filesystem::path& config_root, std::size_t ticks);

/// The same with the guidance of a plan: none, at gain 0, and as the plan has it.
/// @param plan  its YAML, with guidance and a tool of the cell's size
/// @throws std::invalid_argument also where it has neither; config::ConfigError
[[nodiscard]] std::vector<LevelCost> TimeGuidance(const std::filesystem::path& config_root,
                                                  const std::filesystem::path& plan, std::size_t ticks);

/// By how much the loop's median is above another level's [us].
[[nodiscard]] double AddedMedian_us(const LevelCost& level, const LevelCost& off);

/// Says in how many ticks the tool pressed, and whether the loop stopped itself.
[[nodiscard]] std::string TooFewText(std::size_t pressed, std::size_t ticks, const TickBench& bench);

}  // namespace osteon::studies
