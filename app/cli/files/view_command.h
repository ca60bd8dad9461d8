#pragma once

#include <CLI/CLI.hpp>

#include "session/view/view.h"

namespace osteon::app {

/// The subcommand `view` of the command line.
class ViewCommand {
 public:
  explicit ViewCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run() const { return session::RunView(options_); }

 private:
  session::ViewOptions options_;
  CLI::App* sub_;
};

}  // namespace osteon::app
