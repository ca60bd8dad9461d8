#pragma once

#include "app/cli/usage/subcommand.h"

namespace osteon::app {

// Each function adds a subcommand of `osteon`, or several, to the parser `app` and to the list `all`.

void AddDemoCommand(CLI::App& app, Subcommands& all);
/// `cell`, a cell's simulated side, and `run`, its controller.
void AddCellCommands(CLI::App& app, Subcommands& all);
void AddGuardCommand(CLI::App& app, Subcommands& all);
void AddSimulateCommand(CLI::App& app, Subcommands& all);
/// `pause`, `resume`, `recover`, `stop` and `status`: requests to a running cell.
void AddOperatorCommands(CLI::App& app, Subcommands& all);
/// `tell`: requests to a running session of a procedure.
void AddTellCommand(CLI::App& app, Subcommands& all);
/// `new-cell`: writes a short cell file to begin with.
void AddNewCellCommand(CLI::App& app, Subcommands& all);
/// `schema`: writes the JSON Schema of every kind of YAML file, from the readers' own keys
/// (config/reading/strict/key_table.h).
void AddSchemaCommand(CLI::App& app, Subcommands& all);
void AddExportCommand(CLI::App& app, Subcommands& all);
void AddReplayCommand(CLI::App& app, Subcommands& all);
void AddReportCommand(CLI::App& app, Subcommands& all);
void AddViewCommand(CLI::App& app, Subcommands& all);

}  // namespace osteon::app
