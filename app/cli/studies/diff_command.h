#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "studies/diff/diff.h"

namespace osteon::app {

/// The subcommand `diff` of the command line.
class DiffCommand {
 public:
  explicit DiffCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::string& command_line);

 private:
  studies::DiffOptions options_;
  std::vector<std::filesystem::path> recordings_;
  CLI::App* sub_;
};

}  // namespace osteon::app
