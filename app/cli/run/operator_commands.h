#pragma once

#include <array>

#include <CLI/CLI.hpp>

#include "session/run/ask_running_cell.h"

namespace osteon::app {

/// The subcommands `pause`, `resume`, `recover`, `stop` and `status`, which send a request to a running cell.
class OperatorCommands {
 public:
  explicit OperatorCommands(CLI::App& app);

  [[nodiscard]] bool asked() const;
  /// @returns the process's exit code.
  [[nodiscard]] int Run();

 private:
  session::AskOptions options_;
  std::array<CLI::App*, 5> subs_{};
};

}  // namespace osteon::app
