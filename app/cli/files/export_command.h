#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/files/recorded_mesh_options.h"
#include "session/replay/export_recording.h"

namespace osteon::app {

/// The subcommand `export` of the command line.
class ExportCommand {
 public:
  explicit ExportCommand(CLI::App& app);

  [[nodiscard]] bool asked() const { return sub_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run() const;

 private:
  session::ExportOptions options_;
  RecordedMeshOptions mesh_;
  CLI::App* sub_;
};

}  // namespace osteon::app
