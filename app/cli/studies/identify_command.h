#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "studies/identify/identify.h"

namespace osteon::app {

/// The subcommand `identify` of the command line.
class IdentifyCommand {
 public:
  explicit IdentifyCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::IdentifyOptions options_;
  std::string cell_;
  std::vector<std::string> runs_{"noise", "free", "validate"}, axes_{"x", "y", "z"};
  std::vector<double> speeds_mm_per_s_{10.0, 50.0}, joint_speeds_deg_per_s_{8.6};
  CLI::App* sub_;
};

}  // namespace osteon::app
