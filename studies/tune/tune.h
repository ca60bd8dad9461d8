#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon tune`.
struct TuneOptions {
  std::filesystem::path cell;
  std::filesystem::path out{"tune"};
  std::filesystem::path json{};  ///< a second copy of tune.json
  /// A file of `osteon identify` for this cell; empty: the cell's own, if it names one.
  std::filesystem::path identified{};
  std::filesystem::path plan{};  ///< surgical plan whose guidance is judged as well; empty: none
  double worst_age_ms{2.0};      ///< largest age of the pose for which a contact model was computed
  double margin{1.1};            ///< gain margin that the recommended gains must have
  std::optional<double> loss{};  ///< share of lost commands; default: as identified, else 0.01
  /// Delays of commands and of the sensor; each must be whole periods of the cell. Default: as identified;
  /// otherwise one period, but at least 1 ms.
  std::optional<double> jitter_ms{}, sensor_delay_ms{};
  double human_grip_N_per_m{3e3}, stiffest_grip_N_per_m{10e3};
  int dampings{16};  ///< number of dampings in the map; they range from 5 to 500 N s/m
  int threads{2};
  std::string command_line{};
  Sharding sharding{};
};

/// Runs `osteon tune CELL.yaml`: finds how stiff a wall the cell's loop may render for each drag of the
/// virtual tool, and the gains that are stable with every hand of the grid. Writes tune.json, .csv, .html,
/// pictures and gains.yaml into a folder, and caches the computed numbers there for the next call with the
/// same parameters.
/// @returns the process's exit code: 0; 1 if a file can't be written or no gains are stable with all hands; 2
/// bad input; 130 ended by Ctrl-C.
[[nodiscard]] int RunTune(const TuneOptions& options);

}  // namespace osteon::studies
