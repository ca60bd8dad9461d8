#pragma once

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

#include "base/child_process.h"
#include "config/reading/load.h"

namespace osteon::session {

/// The cell that a CellProcess simulates, and how.
struct CellProcessParams {
  std::filesystem::path cell;                ///< the cell's YAML file
  std::optional<config::ToolChoice> tool{};  ///< replaces the cell's tool
  std::filesystem::path identified{};        ///< file of `osteon identify`; empty: the cell's own, if any
  std::filesystem::path plan{};  ///< plan that the simulated operator follows; empty: the cell's own script
  std::string hand{"expert"};    ///< the simulated operator's hand
  double seconds{0.0};           ///< duration of the operator's script; 0: as the cell's file says
  std::uint16_t first_port{0};   ///< see UseSimulatedWires; 0: the ports of the cell's file
  int cpu{-1};                   ///< CPU for the cell's real-time threads; -1: any
  bool guard{false};             ///< start the cell's guard as well
};

/// Starts this program again as `osteon cell` in a separate process, and as `osteon guard` in another if the
/// cell has a guard. Both processes end when this process ends, even if it crashes.
class CellProcess {
 public:
  /// Starts the processes. The error says why that failed.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellProcess>, std::string> Start(
      const CellProcessParams& params);
  /// Ends the processes.
  ~CellProcess();
  CellProcess(const CellProcess&) = delete;
  CellProcess& operator=(const CellProcess&) = delete;

  /// Whether the cell's process has ended by itself. It then has printed the reason on stderr.
  [[nodiscard]] bool Ended() { return process_->Ended(); }

  /// Asks the cell's process to end at once. Callable from any thread.
  void AskToEnd() const { process_->Send(SIGTERM); }

  /// Waits until the cell's process has ended, and kills it after 5 s; then ends the guard.
  /// @returns the report of the cell's process, as `osteon cell --json` writes it; empty if it wrote none
  [[nodiscard]] std::string End();

 private:
  explicit CellProcess(std::filesystem::path report) : report_(std::move(report)) {}

  std::unique_ptr<base::ChildProcess> process_;  // process of the cell
  std::unique_ptr<base::ChildProcess> guard_;    // process of the guard; null: none was started
  std::filesystem::path report_;                 // temporary file for the cell's report
};

}  // namespace osteon::session
