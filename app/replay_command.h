#pragma once

#include <CLI/CLI.hpp>

#include "app/replay_recording.h"

namespace osteon::app {

/// The subcommand `replay` of the command line.
class ReplayCommand {
 public:
  explicit ReplayCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run() const { return RunReplay(options_); }

 private:
  ReplayOptions options_;
  CLI::App* sub_;
};

}  // namespace osteon::app
