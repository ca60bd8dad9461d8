#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace osteon::app {

/// The subcommand `merge` of the command line: runs a study's command again with the items that its shards
/// have computed, so that files, table and exit code are those of one run.
class MergeCommand {
 public:
  explicit MergeCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code: that of the study's command; 2 if the parts do not fit together.
  [[nodiscard]] int Run(const std::filesystem::path& config_root);

 private:
  std::vector<std::filesystem::path> parts_;
  std::filesystem::path json_, out_;
  CLI::App* sub_;
};

}  // namespace osteon::app
