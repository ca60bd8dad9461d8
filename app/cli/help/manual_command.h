#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// The subcommands `manual` and `completion`: what the command line takes, for readers and for shells.
class ManualCommands {
 public:
  explicit ManualCommands(CLI::App& app);

  [[nodiscard]] bool asked() const { return manual_->parsed() || completion_->parsed(); }
  /// @param apps  the executables that are documented as one command, the one with its name first
  /// @returns the process's exit code.
  [[nodiscard]] int Run(std::span<const CLI::App* const> apps) const;

 private:
  std::filesystem::path man_, markdown_, json_;
  std::string shell_;
  CLI::App *manual_, *completion_;
};

}  // namespace osteon::app
