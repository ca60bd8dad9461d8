#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "app/cli/run/procedure_options.h"
#include "session/run/operate.h"
#include "session/run/simulated_cell_run.h"

namespace osteon::app {

/// The subcommands `cell` and `run` of the command line: a cell's simulated side and its controller.
class CellCommands {
 public:
  explicit CellCommands(CLI::App& app);

  [[nodiscard]] bool asked() const { return cell_->parsed() || run_->parsed(); }
  /// @returns the process's exit code.
  [[nodiscard]] int Run(const std::filesystem::path& config_root, const std::string& command_line);

 private:
  session::SimulatedCellOptions simulated_;
  session::OperateOptions operate_;
  ProcedureOptions procedure_, cell_procedure_;
  std::string name_, tool_;
  std::filesystem::path identified_;
  CLI::App *cell_, *run_;
};

}  // namespace osteon::app
