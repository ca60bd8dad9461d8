#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "control/compliance/compliance.h"
#include "simulation/fidelity/frame_workload.h"
#include "studies/bench/tick_bench.h"

namespace osteon::studies {

/// A level of compliance, which says which parts of a timed cell yield, with a name.
struct NamedLevels {
  std::string name;
  control::ComplianceParams params;
};

/// Returns the levels "off", "tool", "layer", "mount" and "all" for the demo's cell. With "tool" the reamer
/// bends, with "layer" the cartilage yields, and with "mount" the bone is on a mount of 12 kg and 10 Hz, 80
/// mm below the cup.
/// @throws std::invalid_argument if the cell's tool or scene does not define its compliance.
[[nodiscard]] std::vector<NamedLevels> LevelsOf(const config::CellConfig& cell);

/// The times of a tick with one level of compliance.
struct LevelCost {
  std::string name;
  simulation::TimeFigures tick, loop;  ///< the whole tick; the servo loop alone
  int allocations{0};
  double force_N{0.0};  ///< mean coupling force
  double guided{0.0};   ///< share of the ticks in which guidance acts
  bool realtime{false};
};

/// Times the tick of cells/demo.yaml with each level of LevelsOf, tick by tick in turn in one run. On Ctrl-C
/// the figures are of the ticks so far.
/// @throws std::runtime_error if the tool pressed in fewer than `ticks` ticks with one of the levels;
/// std::invalid_argument as BenchCell does.
[[nodiscard]] std::vector<LevelCost> TimeLevels(const std::filesystem::path& config_root, std::size_t ticks);

/// Times the same tick without guidance, with the plan's guidance at gain 0, and as planned, in turn.
/// @param plan  the plan's YAML file, with guidance and a tool of the cell's size
/// @throws as TimeLevels; std::invalid_argument also if the plan lacks one of these; config::ConfigError
[[nodiscard]] std::vector<LevelCost> TimeGuidance(const std::filesystem::path& config_root,
                                                  const std::filesystem::path& plan, std::size_t ticks);

/// The median time of the loop with `level` less that with `off` [us].
[[nodiscard]] double AddedMedian_us(const LevelCost& level, const LevelCost& off);

/// Says in how many ticks the tool pressed, and whether the loop stopped itself.
[[nodiscard]] std::string TooFewText(std::size_t pressed, std::size_t ticks, const TickBench& bench);

}  // namespace osteon::studies
