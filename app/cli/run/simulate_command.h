#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "session/run/simulate.h"

namespace osteon::app {

/// The subcommand `simulate` of the command line.
class SimulateCommand {
 public:
  explicit SimulateCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root);

 private:
  session::SimulateOptions options_;
  std::string cell_, listen_;
  CLI::App* sub_;
};

}  // namespace osteon::app
