#include "app/cli/studies/studies.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "app/cli/studies/shard_option.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/setup/engine_choice.h"
#include "studies/failures/failure.h"
#include "studies/failures/failures.h"
#include "studies/faults/fault_table.h"
#include "studies/kill/kill_table.h"

namespace osteon::app {
namespace {

// Returns the names of the kill trials' victims in the form of the command line: "engine-hung".
std::vector<std::string> VictimWords() {
  std::vector<std::string> words;
  for (int v = 0; v < studies::kKillVictims; ++v) {
    words.emplace_back(NameOf(static_cast<studies::KillVictim>(v)));
    std::ranges::replace(words.back(), ' ', '-');
  }
  return words;
}

// Returns the victims with these names, in the order of the enumeration.
std::vector<studies::KillVictim> Victims(const std::vector<std::string>& asked) {
  const std::vector<std::string> words = VictimWords();
  std::vector<studies::KillVictim> victims;
  for (int v = 0; v < studies::kKillVictims; ++v)
    if (std::ranges::find(asked, words[static_cast<std::size_t>(v)]) != asked.end())
      victims.push_back(static_cast<studies::KillVictim>(v));
  return victims;
}

class FailuresCommand final : public Subcommand {
 public:
  explicit FailuresCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  // The tables that the options request. If any is requested, the scenarios are not run.
  struct Tables {
    bool faults{false}, kill{false};
    int times{20};  // trials for each victim
    std::vector<std::string> victims{};
  };

  studies::FailureOptions options_;
  Tables tables_;
};

FailuresCommand::FailuresCommand(CLI::App& app) : Subcommand(AddStudy(app, "failures")) {
  auto* ids =
      sub_->add_option("scenarios", options_.ids, "numbers of the scenarios; without any, all of them")
          ->check(NumberWithin(1, 99));
  auto* out =
      sub_->add_option("--out", options_.out, "folder for failures.html and a picture of each scenario")
          ->type_name("FOLDER");
  auto* faults =
      sub_->add_flag("--faults", tables_.faults,
                     "instead of the scenarios: every fault of the cell in every state, in virtual "
                     "time (docs/states.md)")
          ->excludes(ids)
          ->excludes(out);
  auto* kill =
      sub_->add_flag("--kill", tables_.kill,
                     "instead of the scenarios: processes and threads are killed in full contact at 150 N: "
                     "controller, servo loop, simulation, recorder, guard, cell, the engine's process "
                     "(docs/guard.md)")
          ->excludes(ids)
          ->excludes(out)
          ->excludes(faults);
  sub_->add_option("--times", tables_.times, "number of trials of each kind")
      ->check(NumberWithin(1, 1000))
      ->needs(kill)
      ->capture_default_str();
  sub_->add_option("--victims", tables_.victims, "only these; without it each")
      ->type_name("LIST")
      ->delimiter(',')
      ->check(OneOf(VictimWords()))
      ->needs(kill);
  sub_->add_option("--markdown", options_.markdown,
                   "write a page with the pictures of --out there, as docs/failures.md")
      ->type_name("FILE")
      ->needs(out);
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  AddShardOption(*sub_, options_.sharding)->excludes(faults)->excludes(kill);
  AddDeviceOption(*sub_, options_.device);
  AddEngineOption(*sub_, options_.engine, session::EngineNames(), "the engine that must keep the bounds",
                  "; reference is slow");
  sub_->add_flag("--quick", options_.quick, "small scenes, as in the tests: seconds instead of minutes");
  std::string list = "Scenarios:\n";
  for (const studies::FailureScenario& scenario : studies::FailureScenarios())
    list += fmt::format("  {:>2}  {}\n", scenario.id, scenario.name);
  sub_->footer(
      list +
      "\nExit code 1: a baseline did not fail, Osteon exceeded a bound, a fault did not lead to the stated "
      "reaction, or the arm did not stop within its limits after a kill\n\nExamples:\n"
      "  osteon failures\n  osteon failures 1 9 --out failures\n  osteon failures --quick --json "
      "failures.json\n"
      "  osteon failures 21 --device llvmpipe\n  osteon failures --faults --json faults.json\n"
      "  osteon failures --kill --times 1\n  osteon failures --kill --victims engine,engine-hung");
}

int FailuresCommand::Run(const Invocation& invocation) {
  if (tables_.faults) return studies::RunFaultTable({.json = options_.json});
  if (tables_.kill) {
    if (!session::KeepsUpWithWallTime(options_.engine)) {
      fmt::print(
          stderr,
          "osteon failures: --engine reference: found --kill, accepted without it: too slow for wall time\n");
      return 2;
    }
    return studies::RunKillTable({.config_root = invocation.config_root,
                                  .times = tables_.times,
                                  .victims = Victims(tables_.victims),
                                  .json = options_.json,
                                  .engine = options_.engine,
                                  .device = options_.device});
  }
  options_.command_line = invocation.command_line;
  TakeInvocation(invocation, options_.sharding);
  return studies::RunFailures(options_);
}

}  // namespace

void AddFailuresCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<FailuresCommand>(app));
}

}  // namespace osteon::app
