#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "studies/transparency/transparency.h"

namespace osteon::app {

/// The subcommand `transparency` of the command line.
class TransparencyCommand {
 public:
  explicit TransparencyCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  studies::TransparencyOptions options_;
  std::string cell_;
  CLI::App* sub_;
};

}  // namespace osteon::app
