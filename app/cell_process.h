#pragma once

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <tl/expected.hpp>

#include "app/child_process.h"
#include "config/load.h"

namespace osteon::app {

struct CellProcessParams {
  std::filesystem::path cell;                ///< its YAML
  std::optional<config::ToolChoice> tool{};  ///< instead of the cell's
  double seconds{0.0};                       ///< of the operator's script; 0: as the file says
  std::uint16_t first_port{0};               ///< as UseSimulatedWires; 0: the file's
  int cpu{-1};                               ///< of its real-time threads; -1: any
  bool guard{false};                         ///< the cell has one: it is started as well
};

/// `osteon cell` as a process of its own, from this program's file, and `osteon guard` as another where the
/// cell has one. They end with this process, however that ends.
class CellProcess {
 public:
  /// The error says why it could not be started.
  [[nodiscard]] static tl::expected<std::unique_ptr<CellProcess>, std::string> Start(
      const CellProcessParams& params);
  /// Ends it.
  ~CellProcess();
  CellProcess(const CellProcess&) = delete;
  CellProcess& operator=(const CellProcess&) = delete;

  /// It has ended by itself: then it has said why on stderr.
  [[nodiscard]] bool Ended() { return process_->Ended(); }

  /// Tells it to end, at once. Any thread.
  void AskToEnd() const { process_->Send(SIGTERM); }

  /// Waits for its end, and kills it where it takes longer than 5 s; then ends the guard. @returns what it
  /// says about itself, as `osteon cell --json` writes it; empty where it could not.
  [[nodiscard]] std::string End();

 private:
  explicit CellProcess(std::filesystem::path report) : report_(std::move(report)) {}

  std::unique_ptr<ChildProcess> process_, guard_;
  std::filesystem::path report_;
};

}  // namespace osteon::app
