#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/sharding/shard.h"

namespace osteon::studies {

/// Options of `osteon regress --sweep`.
struct SweepOptions {
  std::filesystem::path config_root;
  std::string sweep;                         ///< name of a file under sweeps/, or a file
  std::filesystem::path out{"regress_out"};  ///< folder for sweep.html and sweep.csv
  std::filesystem::path json;
  int jobs{0};                   ///< runs in parallel; 0: one per core
  std::string device;            ///< part of a Vulkan device's name; empty: the default device
  std::vector<std::string> set;  ///< KEY=VALUE, overrides the scenario's cell
  std::string command_line;
  Sharding sharding{};
};

/// Runs `osteon regress --sweep`.
/// @returns the process's exit code: 0; 1 if a run could not be made or a file could not be written; 2 wrong
/// options or files; 130 ended by Ctrl-C.
[[nodiscard]] int RunSweep(const SweepOptions& options);

}  // namespace osteon::studies
