#include "app/cli/studies/merge_command.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "app/cli/studies/failures_command.h"
#include "app/cli/studies/measure_commands.h"
#include "app/cli/studies/regress_command.h"
#include "app/cli/studies/tune_command.h"
#include "app/cli/usage/command_line.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "studies/sharding/part_set.h"

namespace osteon::app {
namespace {

// Parses a study's command line, given as words, and runs the study on the items of the parts.
int RunStudy(const std::filesystem::path& config_root, std::vector<std::string> words,
             const studies::PartSet& parts) {
  CLI::App app{"the studies that can be split", "osteon"};
  FailuresCommand failures(app);
  MeasureCommands measure(app);
  TuneCommand tune(app);
  RegressCommand regress(app);
  app.require_subcommand(1);
  const Invocation invocation{.command_line = CommandLine(words), .words = words, .parts = &parts};
  std::ranges::reverse(words);  // CLI11 takes the words in reverse order
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return session::Fail(
        "merge", fmt::format("{}: found a command that cannot be read, accepted one of this build: {}",
                             parts.first_file().string(), UsageError(app, error)));
  }
  try {
    if (measure.asked()) return measure.Run(config_root, invocation);
    if (tune.asked()) return tune.Run(config_root, invocation);
    if (failures.asked()) return failures.Run(config_root, invocation);
    return regress.Run(config_root, invocation);
  } catch (const std::invalid_argument& error) {  // an item that the study cannot read
    return session::Fail("merge", error.what());
  }
}

}  // namespace

MergeCommand::MergeCommand(CLI::App& app) : sub_(AddStudy(app, "merge")) {
  sub_->add_option("parts", parts_, "the files of all shards of one run, in any order")
      ->type_name("PART.json")
      ->required();
  sub_->add_option("--json", json_, "write the figures there, as the command's own --json")
      ->type_name("FILE");
  sub_->add_option("--out", out_, "folder for pages and pictures, as the command's own --out")
      ->type_name("FOLDER");
  sub_->footer(
      "The result is what one run gives, to the bit where it is not a time. Further options of the command, "
      "as --junit, are those that its shards were given.\n\n"
      "Exit code: that of the command; 2 if the parts are not all parts of one run\n\n"
      "Examples:\n  osteon regress --shard 1/2 --json part_1.json\n"
      "  osteon regress --shard 2/2 --json part_2.json\n"
      "  osteon merge part_1.json part_2.json --json regress.json");
}

int MergeCommand::Run(const std::filesystem::path& config_root) {
  const auto parts = studies::PartSet::Read(parts_);
  if (!parts) return session::Fail("merge", parts.error());
  if (const std::string build = session::BuildName(); parts->build() != build)
    return session::Fail("merge",
                         fmt::format("{}: found build {}, accepted {}, this program's: merge with the "
                                     "program that ran the shards",
                                     parts->first_file().string(), parts->build(), build));
  std::vector<std::string> words = parts->words();
  for (const auto& [name, path] : {std::pair("--out", &out_), std::pair("--json", &json_)})
    if (!path->empty()) words.insert(words.end(), {name, path->string()});
  return RunStudy(config_root, std::move(words), *parts);
}

}  // namespace osteon::app
