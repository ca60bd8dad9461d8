#include "app/cli/help/manual_command.h"

#include <tuple>

#include <fmt/format.h>

#include "app/cli/help/command_table.h"
#include "app/cli/help/completion.h"
#include "app/cli/help/manual.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "base/write_text.h"
#include "session/process/exit_code.h"

namespace osteon::app {

ManualCommands::ManualCommands(CLI::App& app)
    : manual_(AddStudy(app, "manual")), completion_(AddStudy(app, "completion")) {
  manual_->add_option("--man", man_, "write the manual page there, as osteon.1")->type_name("FILE");
  manual_->add_option("--markdown", markdown_, "write the page there, as docs/commands.md")
      ->type_name("FILE");
  manual_->add_option("--json", json_, "write the table of subcommands and options there")->type_name("FILE");
  manual_->footer(
      "Without an option the manual page goes to stdout, as roff.\n\n"
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon manual | man -l -\n  osteon manual --man osteon.1 --json manual.json");
  completion_->add_option("shell", shell_, "the shell that reads the script")
      ->required()
      ->check(OneOf({"bash", "zsh", "fish"}));
  completion_->footer(
      "Bash and zsh read the script by `source <(./osteon completion bash)`, fish by `./osteon completion "
      "fish | source`. docs/commands.md says how to keep it for every shell.\n\n"
      "Examples:\n  osteon completion bash\n  osteon completion fish");
}

int ManualCommands::Run(std::span<const CLI::App* const> apps) const {
  const CommandText command = DescribeCommands(apps);
  if (completion_->parsed()) {
    fmt::print("{}", shell_ == "bash"  ? BashCompletion(command)
                     : shell_ == "zsh" ? ZshCompletion(command)
                                       : FishCompletion(command));
    return 0;
  }
  const std::string page = ManPage(command, OSTEON_VERSION);
  if (man_.empty() && markdown_.empty() && json_.empty()) fmt::print("{}", page);
  for (const auto& [file, text] : {std::pair(man_, page), std::pair(markdown_, CommandsPage(command)),
                                   std::pair(json_, ManualJson(command))}) {
    if (file.empty()) continue;
    if (const auto written = base::WriteText(file, text); !written)
      return session::Fail("manual", written.error(), session::kFailed);
  }
  return 0;
}

}  // namespace osteon::app
