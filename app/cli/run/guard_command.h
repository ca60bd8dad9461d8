#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "session/guard/guard.h"

namespace osteon::app {

/// The subcommand `guard` of the command line.
class GuardCommand {
 public:
  explicit GuardCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root);

 private:
  session::GuardOptions options_;
  std::string name_, tool_;
  CLI::App* sub_;
};

}  // namespace osteon::app
