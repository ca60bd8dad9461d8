#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/files/recorded_mesh_options.h"
#include "session/replay/recorded_report.h"

namespace osteon::app {

/// The subcommand `report` of the command line.
class ReportCommand {
 public:
  explicit ReportCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::string& command_line);

 private:
  session::RecordedReportOptions options_;
  RecordedMeshOptions mesh_;
  CLI::App* sub_;
};

}  // namespace osteon::app
