#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "session/run/ask_running_cell.h"

namespace osteon::app {

/// The subcommand `tell` of the command line: sends a request to a running session of a procedure.
class TellCommand {
 public:
  explicit TellCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run();

 private:
  session::TellOptions options_;
  std::vector<std::string> words_;
  CLI::App* sub_;
};

}  // namespace osteon::app
