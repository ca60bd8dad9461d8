#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "session/replay/replay_recording.h"

namespace osteon::app {

/// The subcommand `replay` of the command line.
class ReplayCommand {
 public:
  explicit ReplayCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @param config_root  folder in which cells are found by name. @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root);

 private:
  session::ReplayOptions options_;
  std::string cell_;
  CLI::App* sub_;
};

}  // namespace osteon::app
