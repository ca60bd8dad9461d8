#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "studies/validate/validate.h"

namespace osteon::app {

/// The subcommand `validate` of the command line.
class ValidateCommand {
 public:
  explicit ValidateCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::ValidateOptions options_;
  CLI::App* sub_;
};

}  // namespace osteon::app
