#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon regress --sweep`.
struct SweepOptions {
  std::filesystem::path config_root;
  std::string sweep;                         ///< a name under sweeps/, or a file
  std::filesystem::path out{"regress_out"};  ///< for sweep.html and sweep.csv
  std::filesystem::path json;
  int jobs{0};                   ///< runs in parallel; 0: one per core
  std::string device;            ///< part of a Vulkan device's name
  std::vector<std::string> set;  ///< KEY=VALUE, overrides the scenario's cell
  std::string command_line;
  Sharding sharding{};
};

/// Runs `osteon regress --sweep`.
/// @returns the process's exit code: 0; 1 a run could not be made, or a file not written; 2 wrong options or
/// files; 130 Ctrl-C.
[[nodiscard]] int RunSweep(const SweepOptions& options);

}  // namespace osteon::studies
