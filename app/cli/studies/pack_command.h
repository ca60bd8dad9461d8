#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "studies/pack/pack.h"

namespace osteon::app {

/// The subcommand `pack` of the command line.
class PackCommand {
 public:
  explicit PackCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  // Options that are texts on the command line and other types in PackOptions.
  struct Texts {
    std::string mode{"overlap"}, cup, region;
    std::vector<std::string> path;
  };

  // Converts the texts. @returns what is wrong with them.
  [[nodiscard]] std::string Read();

  studies::PackOptions options_;
  Texts texts_;
  CLI::App* sub_;
};

}  // namespace osteon::app
