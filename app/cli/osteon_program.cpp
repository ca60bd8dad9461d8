#include "app/cli/osteon_program.h"

#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/cli/osteon_commands.h"
#include "app/cli/usage/command_line.h"
#include "app/cli/usage/study_commands.h"

namespace osteon::app {
namespace {

int ParseAndRun(int argc, char** argv) {
  CLI::App app{OsteonCommands::kDescription, OsteonCommands::kName};
  OsteonCommands commands(app);
  if (const auto code = ParseCommandLine(app, argc, argv)) return *code;
  return commands.Run(CommandLine(argc, argv));
}

}  // namespace

int RunOsteon(int argc, char** argv) {
  // The launcher asks which executable this command needs, so that it can build that one.
  if (argc > 1 && std::string_view(argv[1]) == "--executable-of") {
    fmt::print("{}\n", AsksForStudy(argc - 1, argv + 1) ? "osteon-studies" : "osteon");
    return 0;
  }
  if (AsksForStudy(argc, argv)) return BecomeStudies(argv);
  return RunMain([&] { return ParseAndRun(argc, argv); });
}

}  // namespace osteon::app
