#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "config/load.h"
#include "hil/cell_host.h"

namespace osteon::app {

struct SimulatedCellOptions {
  std::filesystem::path cell;                ///< its YAML
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  double seconds{0.0};                       ///< of the operator's script; 0: as the file says
  std::optional<std::uint16_t> port{};       ///< the first of its ports, instead of the file's
  int cpu{-1};                    ///< its real-time threads are pinned to it, all others stay off; -1: any
  std::filesystem::path json{};   ///< what it was, written at its end
  std::filesystem::path trace{};  ///< a CSV file of each of its cycles, while it runs; empty: none
};

/// `osteon cell`: the simulated cell alone, on its real protocols, until Ctrl-C. Says on stdout what is
/// where, each new state of the arm's session and what it waits for (CellScreen).
/// @returns the process's exit code: 0 ended by Ctrl-C or SIGTERM; 1 the JSON could not be written; 2
/// something was wrong with the input, or a port is taken.
[[nodiscard]] int RunSimulatedCell(const SimulatedCellOptions& options);

/// One JSON object, schema osteon.cell/1. Of an arm on RSI `arm.rsi` says in words what `arm.session` is
/// there; of one on FRI it is null.
[[nodiscard]] std::string ToJson(const hil::CellHostState& state, const config::ArmLinkConfig& link);

}  // namespace osteon::app
