#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// The subcommands `manual`, which prints the manual or writes it to files, and `completion`, which prints
/// the script by which a shell completes the command line.
class ManualCommands {
 public:
  explicit ManualCommands(CLI::App& app);

  /// Whether `manual` or `completion` was on the command line.
  [[nodiscard]] bool asked() const { return manual_->parsed() || completion_->parsed(); }
  /// @param apps  the executables that are documented as one command; the first one has the command's name
  /// @returns the process's exit code.
  [[nodiscard]] int Run(std::span<const CLI::App* const> apps) const;

 private:
  std::filesystem::path man_, markdown_, json_;
  std::string shell_;
  CLI::App *manual_, *completion_;
};

}  // namespace osteon::app
