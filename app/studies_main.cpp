// The command osteon-studies: benchmarks, charts, failures, studies, and the manual of both programs.
// `osteon` hands over to it. Exit codes as in osteon_program.h.

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/cli/help/manual_command.h"
#include "app/cli/osteon_commands.h"
#include "app/cli/studies/assess_command.h"
#include "app/cli/studies/calibrate_command.h"
#include "app/cli/studies/capability_command.h"
#include "app/cli/studies/diff_command.h"
#include "app/cli/studies/failures_command.h"
#include "app/cli/studies/identify_command.h"
#include "app/cli/studies/measure_commands.h"
#include "app/cli/studies/merge_command.h"
#include "app/cli/studies/pack_command.h"
#include "app/cli/studies/plan_command.h"
#include "app/cli/studies/regress_command.h"
#include "app/cli/studies/soak_command.h"
#include "app/cli/studies/surgical_plan_command.h"
#include "app/cli/studies/transparency_command.h"
#include "app/cli/studies/tune_command.h"
#include "app/cli/studies/validate_command.h"
#include "app/cli/usage/command_line.h"
#include "config/reading/config_file_tracker.h"

namespace {

using osteon::app::OsteonCommands;

int Run(int argc, char** argv) {
  CLI::App app{"what packs, measures and decides", OsteonCommands::kName};
  std::filesystem::path config_root;
  osteon::app::PrepareTop(app, config_root);

  osteon::app::PackCommand pack(app);
  osteon::app::FailuresCommand failures(app);
  osteon::app::MeasureCommands measure(app);
  osteon::app::CalibrateCommand calibrate(app);
  osteon::app::CapabilityCommand capability(app);
  osteon::app::TransparencyCommand transparency(app);
  osteon::app::IdentifyCommand identify(app);
  osteon::app::PlanCommand plan(app);
  osteon::app::SurgicalPlanCommand surgical_plan(app);
  osteon::app::AssessCommand assess(app);
  osteon::app::TuneCommand tune(app);
  osteon::app::RegressCommand regress(app);
  osteon::app::ValidateCommand validate(app);
  osteon::app::SoakCommand soak(app);
  osteon::app::DiffCommand diff(app);
  osteon::app::MergeCommand merge(app);
  osteon::app::ManualCommands manual(app);

  if (const auto code = osteon::app::ParseCommandLine(app, argc, argv)) return *code;
  osteon::config::SetShippedFolder(config_root);
  const std::string command_line = osteon::app::CommandLine(argc, argv);
  const osteon::app::Invocation invocation{.command_line = command_line, .words = {argv + 1, argv + argc}};
  if (pack.asked()) return pack.Run(config_root, command_line);
  if (failures.asked()) return failures.Run(config_root, invocation);
  if (measure.asked()) return measure.Run(config_root, invocation);
  if (calibrate.asked()) return calibrate.Run(config_root, command_line);
  if (capability.asked()) return capability.Run(config_root, command_line);
  if (transparency.asked()) return transparency.Run(config_root, command_line);
  if (identify.asked()) return identify.Run(config_root, command_line);
  if (plan.asked()) return plan.Run(config_root, command_line);
  if (surgical_plan.asked()) return surgical_plan.Run(config_root);
  if (assess.asked()) return assess.Run(config_root, command_line);
  if (tune.asked()) return tune.Run(config_root, invocation);
  if (regress.asked()) return regress.Run(config_root, invocation);
  if (validate.asked()) return validate.Run(config_root, command_line);
  if (soak.asked()) return soak.Run(config_root, command_line);
  if (diff.asked()) return diff.Run(command_line);
  if (merge.asked()) return merge.Run(config_root);
  if (manual.asked()) {
    CLI::App osteon{OsteonCommands::kDescription, OsteonCommands::kName};
    const OsteonCommands commands(osteon);
    const CLI::App* const both[] = {&osteon, &app};
    return manual.Run(both);
  }
  fmt::print("{}", app.help());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return osteon::app::RunMain([&] { return Run(argc, argv); });
}
