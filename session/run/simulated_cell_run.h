#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "config/reading/load.h"
#include "hil/cell_host.h"
#include "session/run/live_views.h"

namespace osteon::session {

struct SimulatedCellOptions {
  std::filesystem::path cell;  ///< the cell's YAML file
  /// Replaces the cell's tool. With a plan: the tool with which the simulated operator begins; absent: the
  /// plan's first tool.
  std::optional<config::ToolChoice> tool{};
  std::filesystem::path identified{};  ///< file of `osteon identify`; empty: the cell's own, if any
  std::filesystem::path plan{};  ///< plan that the simulated operator follows; empty: the cell's own script
  std::string hand{"expert"};    ///< the simulated operator's hand: expert, novice
  double seconds{0.0};           ///< duration of the operator's script; 0: as the cell's file says
  std::optional<std::uint16_t> port{};  ///< first port of the cell; absent: the ports of its file
  /// CPU to which the real-time threads are pinned; all other threads are kept off this CPU; -1: any.
  int cpu{-1};
  std::filesystem::path json{};   ///< file for the report, written when the cell ends; empty: none
  std::filesystem::path trace{};  ///< CSV file with a row for each cycle, written during the run; empty: none
  ConsoleChoice console{};        ///< where the cell's page is served
};

/// Runs `osteon cell`: the simulated cell alone, on its real protocols, until Ctrl-C. Prints the addresses of
/// its devices and of its page, each new state of the arm's session, and what the cell waits for
/// (CellScreen).
/// @returns the process's exit code: 0 ended by Ctrl-C or SIGTERM; 1 the JSON could not be written; 2 wrong
/// input, or a port is taken.
[[nodiscard]] int RunSimulatedCell(const SimulatedCellOptions& options);

/// JSON object, schema osteon.cell/1. For an arm on RSI, `arm.rsi` is `arm.session` in words; for an arm on
/// FRI, `arm.rsi` is null.
[[nodiscard]] std::string ToJson(const hil::CellHostState& state, const config::ArmLinkConfig& link);

}  // namespace osteon::session
