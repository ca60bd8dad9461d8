#pragma once

#include "app/cli/usage/subcommand.h"

namespace osteon::app {

// Each function adds a subcommand of osteon-studies, or several, to the parser `app` and to the list `all`.

void AddPackCommand(CLI::App& app, Subcommands& all);
/// `failures`: scenarios, fault matrix, kill trials.
void AddFailuresCommand(CLI::App& app, Subcommands& all);
/// `bench frame`, `bench kinematics` …, `chart scaling`, `chart speed-accuracy`, `chart compliance`.
void AddMeasureCommands(CLI::App& app, Subcommands& all);
void AddCalibrateCommand(CLI::App& app, Subcommands& all);
void AddCapabilityCommand(CLI::App& app, Subcommands& all);
void AddTransparencyCommand(CLI::App& app, Subcommands& all);
void AddIdentifyCommand(CLI::App& app, Subcommands& all);
void AddPlanCommand(CLI::App& app, Subcommands& all);
void AddSurgicalPlanCommand(CLI::App& app, Subcommands& all);
void AddAssessCommand(CLI::App& app, Subcommands& all);
void AddTuneCommand(CLI::App& app, Subcommands& all);
/// `regress`: scenarios against golden traces, or a sweep.
void AddRegressCommand(CLI::App& app, Subcommands& all);
void AddValidateCommand(CLI::App& app, Subcommands& all);
void AddSoakCommand(CLI::App& app, Subcommands& all);
void AddDiffCommand(CLI::App& app, Subcommands& all);
/// `merge`: runs a study's command again with the items that its shards have computed, so that files, table
/// and exit code are those of one run. Its exit code is 2 if the parts do not fit together.
void AddMergeCommand(CLI::App& app, Subcommands& all);

}  // namespace osteon::app
