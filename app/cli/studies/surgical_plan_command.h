#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/assess/surgical_plan_result.h"

namespace osteon::app {

/// The subcommand `surgical-plan` of the command line.
class SurgicalPlanCommand {
 public:
  explicit SurgicalPlanCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root);

 private:
  studies::SurgicalPlanOptions options_;
  std::string plan_, cell_, mesh_;
  double scale_{1.0};
  CLI::App* sub_;
};

}  // namespace osteon::app
