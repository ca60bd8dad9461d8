#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/assess/assess_result.h"

namespace osteon::app {

/// The subcommand `assess` of the command line.
class AssessCommand {
 public:
  explicit AssessCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::AssessOptions options_;
  std::string rubric_;
  CLI::App* sub_;
};

}  // namespace osteon::app
