#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// The subcommand `new-cell` of the command line: writes a short cell to begin with.
class NewCellCommand {
 public:
  explicit NewCellCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root) const;

 private:
  std::string name_, from_{"demo"};
  std::filesystem::path json_;
  CLI::App* sub_;
};

}  // namespace osteon::app
