#include "app/cli/studies/studies.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/usage/command_line.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/setup/build_name.h"
#include "studies/sharding/part_set.h"

namespace osteon::app {
namespace {

// Parses a study's command line, given as words. Then runs the study, which takes the results of its items
// from the parts instead of computing them.
int RunStudy(const std::filesystem::path& config_root, std::vector<std::string> words,
             const studies::PartSet& parts) {
  CLI::App app{"the studies that can be split", "osteon"};
  Subcommands all;
  for (const auto add : {AddFailuresCommand, AddMeasureCommands, AddTuneCommand, AddRegressCommand})
    add(app, all);
  app.require_subcommand(1);
  const Invocation invocation{
      .config_root = config_root, .command_line = CommandLine(words), .words = words, .parts = &parts};
  std::ranges::reverse(words);  // CLI11 expects the words in reverse order
  try {
    app.parse(words);
  } catch (const CLI::ParseError& error) {
    return session::Fail(
        "merge", fmt::format("{}: found a command that cannot be read, accepted one of this build: {}",
                             parts.first_file().string(), UsageError(app, error)));
  }
  try {
    return RunAsked(all, invocation).value();
  } catch (const std::invalid_argument& error) {  // an item that the study cannot read
    return session::Fail("merge", error.what());
  }
}

class MergeCommand final : public Subcommand {
 public:
  explicit MergeCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  std::vector<std::filesystem::path> parts_;
  std::filesystem::path json_, out_;
};

MergeCommand::MergeCommand(CLI::App& app) : Subcommand(AddStudy(app, "merge")) {
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

int MergeCommand::Run(const Invocation& invocation) {
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
  return RunStudy(invocation.config_root, std::move(words), *parts);
}

}  // namespace

void AddMergeCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<MergeCommand>(app)); }

}  // namespace osteon::app
