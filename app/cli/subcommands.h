#pragma once

#include "app/cli/usage/subcommand.h"

namespace osteon::app {

/// Add a subcommand of `osteon` to the help, and to the list.
void AddDemoCommand(CLI::App& app, Subcommands& all);
/// A cell's simulated side and its controller: `cell` and `run`.
void AddCellCommands(CLI::App& app, Subcommands& all);
void AddGuardCommand(CLI::App& app, Subcommands& all);
void AddSimulateCommand(CLI::App& app, Subcommands& all);
/// `pause`, `resume`, `recover`, `stop` and `status`, which ask a cell that runs.
void AddOperatorCommands(CLI::App& app, Subcommands& all);
/// Asks a procedure's session that runs.
void AddTellCommand(CLI::App& app, Subcommands& all);
/// Writes a short cell to begin with.
void AddNewCellCommand(CLI::App& app, Subcommands& all);
/// JSON Schema of every kind of YAML file, from the readers' own keys (config/reading/strict/key_table.h).
void AddSchemaCommand(CLI::App& app, Subcommands& all);
void AddExportCommand(CLI::App& app, Subcommands& all);
void AddReplayCommand(CLI::App& app, Subcommands& all);
void AddReportCommand(CLI::App& app, Subcommands& all);
void AddViewCommand(CLI::App& app, Subcommands& all);

}  // namespace osteon::app
