#include "app/cli/usage/command_line.h"

#include <exception>
#include <memory>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "app/cli/help/help_text.h"
#include "app/cli/usage/usage.h"
#include "base/text.h"
#include "config/reading/config_file_tracker.h"
#include "session/process/exit_code.h"
#include "session/process/output.h"
#include "session/setup/build_name.h"

namespace osteon::app {

std::string CommandLine(int argc, char** argv) {
  return CommandLine(std::vector<std::string>(argv + 1, argv + argc));
}

std::string CommandLine(std::span<const std::string> words) {
  std::string line = "./osteon";
  for (const std::string& word : words) {
    const bool plain = word.find_first_of(" \"'$\\") == std::string::npos;
    line += plain ? " " + word : " '" + word + "'";
  }
  return line;
}

void PrepareTop(CLI::App& app, std::filesystem::path& config_root) {
  config_root = config::ShippedFolder();
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this text");
  app.set_version_flag("--version", fmt::format("osteon {} ({})", OSTEON_VERSION, session::CommitName()),
                       "print the version and the commit");
  app.require_subcommand(0, 1);
  app.add_option("--config-root", config_root, "the folder with cells/, robots/, tools/ and so on")
      ->type_name("FOLDER")
      ->default_str("config/ of the project");
}

std::optional<int> ParseCommandLine(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {  // --help or --version was given
      std::ostringstream text;
      const int code = app.exit(error, text, text);
      fmt::print("{}", text.str());
      return code;
    }
    fmt::print(stderr, "{}", base::Printable(UsageError(app, error)));
    return 2;
  }
  if (const std::string wrong = ValidateEnvironment(app); !wrong.empty()) {
    fmt::print(stderr, "{}", base::Printable(wrong));
    return 2;
  }
  return {};
}

int RunMain(const std::function<int()>& run) {
  session::InstallOutput();
  try {
    return session::OutputExitCode(run());
  } catch (const std::exception& error) {
    const session::Failure failure = session::Explain(error);
    fmt::print(stderr, "osteon: {}\n", base::Printable(failure.text));
    return failure.code;
  }
}

}  // namespace osteon::app
