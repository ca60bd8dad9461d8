// The command `osteon`: reads the command line and calls a subcommand. Exit codes: 0 done, 1 the requested
// work failed, 2 wrong usage or bad input, 70 an internal error, 71 out of memory, 130 ended by Ctrl-C, 129
// by SIGHUP, 141 because nobody reads the output.

#include <string_view>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "app/cli/command_line.h"
#include "app/cli/osteon_commands.h"
#include "app/cli/study_commands.h"

namespace {

int Run(int argc, char** argv) {
  CLI::App app{osteon::app::OsteonCommands::kDescription, osteon::app::OsteonCommands::kName};
  osteon::app::OsteonCommands commands(app);
  if (const auto code = osteon::app::ParseCommandLine(app, argc, argv)) return *code;
  return commands.Run(osteon::app::CommandLine(argc, argv));
}

}  // namespace

int main(int argc, char** argv) {
  // the launcher asks what has to be built
  if (argc > 1 && std::string_view(argv[1]) == "--executable-of") {
    fmt::print("{}\n", osteon::app::AsksForStudy(argc - 1, argv + 1) ? "osteon-studies" : "osteon");
    return 0;
  }
  if (osteon::app::AsksForStudy(argc, argv)) return osteon::app::BecomeStudies(argv);
  return osteon::app::RunMain([&] { return Run(argc, argv); });
}
