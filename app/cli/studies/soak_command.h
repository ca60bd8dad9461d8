#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/soak/soak.h"

namespace osteon::app {

/// The subcommand `soak` of the command line.
class SoakCommand {
 public:
  explicit SoakCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::SoakOptions options_;
  bool wall_{false};
  std::optional<double> hours_;
  CLI::App* sub_;
};

}  // namespace osteon::app
