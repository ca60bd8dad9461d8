#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace osteon::app {

struct TuneOptions {
  std::filesystem::path cell;
  std::filesystem::path out{"tune"};
  std::filesystem::path json{};  ///< a further copy of tune.json
  double worst_age_ms{2.0};      ///< of a contact model's pose
  double margin{1.1};
  double loss{0.01};
  /// In whole periods of the cell; one of them, at least 1 ms, where none are given.
  std::optional<double> jitter_ms{}, sensor_delay_ms{};
  double human_grip_N_per_m{3e3}, stiffest_grip_N_per_m{10e3};
  int dampings{16};  ///< of the map, from 5 to 500 N s/m
  int threads{2};
  std::string command_line{};
};

/// `osteon tune CELL.yaml`: how stiff a wall the cell's loop may show, by the virtual tool's drag; and the
/// gains that stand every hand of the grid. Writes tune.json, .csv, .html, pictures and gains.yaml into a
/// folder, and keeps there what was computed: with the same parameters it is not computed again.
/// @returns the process's exit code: 0; 1 where a file can't be written or no gains stand it all; 2 bad
/// input; 130
///   ended by Ctrl-C.
[[nodiscard]] int RunTune(const TuneOptions& options);

}  // namespace osteon::app
