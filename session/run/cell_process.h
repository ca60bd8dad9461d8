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
  std::filesystem::path identified{};        ///< of `osteon identify`, instead of the cell's own; empty: none
  std::filesystem::path plan{};  ///< plan that its simulated operator follows; empty: the cell's own script
  std::string hand{"expert"};    ///< that operator's hand
  double seconds{0.0};           ///< duration of the operator's script; 0: as the file says
  std::uint16_t first_port{0};   ///< see UseSimulatedWires; 0: the file's
  int cpu{-1};                   ///< CPU for its real-time threads; -1: any
  bool guard{false};             ///< start the cell's guard as well
};

/// Runs `osteon cell` as a separate process of this program's file, and `osteon guard` as another if the cell
/// has a guard. Both end with this process, however it ends.
class CellProcess {
 public:
  /// Starts the processes. The error says why that failed.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellProcess>, std::string> Start(
      const CellProcessParams& params);
  /// Ends the processes.
  ~CellProcess();
  CellProcess(const CellProcess&) = delete;
  CellProcess& operator=(const CellProcess&) = delete;

  /// Whether the cell's process has ended by itself; it has then said why on stderr.
  [[nodiscard]] bool Ended() { return process_->Ended(); }

  /// Asks the cell's process to end at once. Callable from any thread.
  void AskToEnd() const { process_->Send(SIGTERM); }

  /// Waits until the cell's process has ended, and kills it after 5 s; then ends the guard.
  /// @returns the report of the cell's process, as `osteon cell --json` writes it; empty if it wrote none
  [[nodiscard]] std::string End();

 private:
  explicit CellProcess(std::filesystem::path report) : report_(std::move(report)) {}

  std::unique_ptr<base::ChildProcess> process_;  // of the cell
  std::unique_ptr<base::ChildProcess> guard_;    // null: none was started
  std::filesystem::path report_;                 // temporary file for the cell's report
};

}  // namespace osteon::session
