#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/studies/shard_option.h"
#include "studies/regress/regress.h"

namespace osteon::app {

/// The subcommand `regress` of the command line: scenarios against golden traces, or a sweep.
class RegressCommand {
 public:
  explicit RegressCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const Invocation& invocation);

 private:
  studies::RegressOptions options_;
  std::string sweep_;  ///< empty: scenarios against their golden traces
  CLI::App* sub_;
};

}  // namespace osteon::app
