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

struct CellProcessParams {
  std::filesystem::path cell;                ///< its YAML
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  std::filesystem::path identified{};        ///< of `osteon identify`, instead of the cell's own; empty: none
  std::filesystem::path plan{};  ///< whose reamers its operator uses; empty: the cell's own script
  std::string hand{"expert"};    ///< of that operator
  double seconds{0.0};           ///< of the operator's script; 0: as the file says
  std::uint16_t first_port{0};   ///< see UseSimulatedWires; 0: the file's
  int cpu{-1};                   ///< for its real-time threads; -1: any
  bool guard{false};             ///< start the cell's guard as well
};

/// Runs `osteon cell` as a separate process of this program's file, and `osteon guard` as another if the cell
/// has a guard. Both end with this process, however it ends.
class CellProcess {
 public:
  /// Starts the processes. The error says why that failed.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellProcess>, std::string> Start(
      const CellProcessParams& params);
  /// Ends it.
  ~CellProcess();
  CellProcess(const CellProcess&) = delete;
  CellProcess& operator=(const CellProcess&) = delete;

  /// Whether it has ended by itself; it has then said why on stderr.
  [[nodiscard]] bool Ended() { return process_->Ended(); }

  /// Asks it to end at once. Callable from any thread.
  void AskToEnd() const { process_->Send(SIGTERM); }

  /// Waits for its end, and kills it after 5 s; then ends the guard. @returns its own report, as `osteon cell
  /// --json` writes it; empty if it could not write one.
  [[nodiscard]] std::string End();

 private:
  explicit CellProcess(std::filesystem::path report) : report_(std::move(report)) {}

  std::unique_ptr<base::ChildProcess> process_, guard_;
  std::filesystem::path report_;
};

}  // namespace osteon::session
