#pragma once

#include <string>

#include <CLI/CLI.hpp>

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
  session::MeshChoice mesh_;
  std::string cup_;
  CLI::App* sub_;
};

}  // namespace osteon::app
