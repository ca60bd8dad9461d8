// The command osteon-studies: benchmarks, charts, failures, studies, and the manual of both programs.
// `osteon` starts it for these subcommands. osteon_program.h lists the exit codes.

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/cli/help/manual_command.h"
#include "app/cli/osteon_commands.h"
#include "app/cli/studies/studies.h"
#include "app/cli/usage/command_line.h"
#include "config/reading/config_file_tracker.h"

namespace osteon::app {
namespace {

int Run(int argc, char** argv) {
  CLI::App app{"what packs, measures and decides", OsteonCommands::kName};
  std::filesystem::path config_root;
  PrepareTop(app, config_root);

  Subcommands all;
  for (const auto add : {AddPackCommand, AddFailuresCommand, AddMeasureCommands, AddCalibrateCommand,
                         AddCapabilityCommand, AddTransparencyCommand, AddIdentifyCommand, AddPlanCommand,
                         AddSurgicalPlanCommand, AddAssessCommand, AddTuneCommand, AddRegressCommand,
                         AddValidateCommand, AddSoakCommand, AddDiffCommand, AddMergeCommand})
    add(app, all);
  ManualCommands manual(app);

  if (const auto code = ParseCommandLine(app, argc, argv)) return *code;
  config::SetShippedFolder(config_root);
  if (const auto code = RunAsked(all, {.config_root = config_root,
                                       .command_line = CommandLine(argc, argv),
                                       .words = {argv + 1, argv + argc}}))
    return *code;
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
}  // namespace osteon::app

int main(int argc, char** argv) {
  return osteon::app::RunMain([&] { return osteon::app::Run(argc, argv); });
}
