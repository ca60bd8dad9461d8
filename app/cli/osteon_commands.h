#pragma once

#include <filesystem>
#include <string>

#include "app/cli/usage/subcommand.h"

namespace osteon::app {

/// The subcommands of `osteon`: those that run a cell, and those that read or write its files. The help also
/// lists the subcommands of the second executable, osteon-studies, which `osteon` starts for them.
class OsteonCommands {
 public:
  /// @param app  made with kName and kDescription; must outlive this object
  explicit OsteonCommands(CLI::App& app);

  static constexpr const char* kName = "osteon";
  static constexpr const char* kDescription =
      "haptic controller and cutting simulation for a hip-reaming robot cell";

  /// Runs the subcommand that was parsed; without one prints the help. @returns the process's exit code.
  [[nodiscard]] int Run(const std::string& command_line);

 private:
  std::filesystem::path config_root_;
  CLI::App& app_;
  Subcommands all_;
};

}  // namespace osteon::app
