#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/studies/shard_option.h"
#include "studies/failures/failures.h"

namespace osteon::app {

/// The subcommand `failures` of the command line: scenarios, fault matrix, kill trials.
class FailuresCommand {
 public:
  explicit FailuresCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const Invocation& invocation);

 private:
  // Options of the tables that can be made instead of running the scenarios.
  struct Tables {
    bool faults{false}, kill{false};
    int times{20};
    std::vector<std::string> victims{};
  };

  studies::FailureOptions options_;
  Tables tables_;
  CLI::App* sub_;
};

}  // namespace osteon::app
