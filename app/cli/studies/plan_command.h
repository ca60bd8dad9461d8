#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/plan/plan_result.h"

namespace osteon::app {

/// The subcommand `plan` of the command line.
class PlanCommand {
 public:
  explicit PlanCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::PlanOptions options_;
  double error_mm_{0.0};
  std::string cell_, tool_, cup_, engine_{"auto"}, device_;
  CLI::App* sub_;
};

}  // namespace osteon::app
