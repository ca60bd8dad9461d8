#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/regress/regress.h"

namespace osteon::app {

/// The subcommand `regress` of the command line.
class RegressCommand {
 public:
  explicit RegressCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  RegressOptions options_;
  CLI::App* sub_;
};

}  // namespace osteon::app
