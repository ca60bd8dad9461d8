#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "studies/capability/capability.h"

namespace osteon::app {

/// The subcommand `capability` of the command line.
class CapabilityCommand {
 public:
  explicit CapabilityCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::CapabilityOptions options_;
  std::string cell_, mount_{"cell"};
  std::vector<double> x_mm_, y_mm_, z_mm_;
  bool no_search_{false};
  CLI::App* sub_;
};

}  // namespace osteon::app
