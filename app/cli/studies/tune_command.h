#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/studies/shard_option.h"
#include "studies/tune/tune.h"

namespace osteon::app {

/// The subcommand `tune` of the command line.
class TuneCommand {
 public:
  explicit TuneCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const Invocation& invocation);

 private:
  studies::TuneOptions options_;
  std::string cell_, plan_;
  CLI::App* sub_;
};

}  // namespace osteon::app
