#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/run/procedure_options.h"
#include "session/run/demo.h"

namespace osteon::app {

/// The subcommand `demo` of the command line.
class DemoCommand {
 public:
  explicit DemoCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  session::DemoOptions options_;
  ProcedureOptions procedure_;
  std::string mesh_, cup_, tool_, cell_{"demo"};
  double scale_{1.0};
  CLI::App* sub_;
  CLI::Option* seconds_option_{nullptr};
  CLI::Option *mesh_option_{nullptr}, *cup_option_{nullptr}, *scale_option_{nullptr}, *tool_option_{nullptr};
};

}  // namespace osteon::app
