#include "app/cli/studies/studies.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/studies/shard_option.h"
#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/plan_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "studies/tune/tune.h"

namespace osteon::app {
namespace {

class TuneCommand final : public Subcommand {
 public:
  explicit TuneCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::TuneOptions options_;
  std::string cell_, plan_;
};

TuneCommand::TuneCommand(CLI::App& app) : Subcommand(AddStudy(app, "tune")) {
  sub_->add_option("cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->required();
  sub_->add_option("--out", options_.out, "folder for tune.html, .json, .csv, pictures and gains.yaml")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "write a further copy of tune.json there")->type_name("FILE");
  sub_->add_option(
          "--plan", plan_,
          "a name under plans/, or a surgical plan's YAML file: which hands its guidance makes unstable")
      ->type_name("PLAN");
  sub_->add_option("--identified", options_.identified,
                   "a file of `osteon identify` for this cell: arm, delays, hands and response as measured")
      ->check(CLI::ExistingFile)
      ->type_name("FILE");
  const auto stand = [](CLI::Option* option) {
    return option->group("What the gains must withstand")->capture_default_str();
  };
  stand(
      sub_->add_option("--margin", options_.margin, "factor by which hand and wall may be stiffer than given")
          ->check(NumberWithin(1, 4)));
  stand(sub_->add_option("--worst-age-ms", options_.worst_age_ms, "greatest age of a contact model's pose")
            ->check(NumberWithin(0, 60)));
  stand(sub_->add_option("--loss", options_.loss,
                         "share of the commands that do not reach the arm; as identified, else 0.01")
            ->check(NumberWithin(0, 0.5)));
  stand(sub_->add_option(
                "--jitter-ms", options_.jitter_ms,
                "greatest delay of a command; as identified, else 1, or the cell's period if that is longer")
            ->check(NumberWithin(0, 30)));
  stand(sub_->add_option("--sensor-delay-ms", options_.sensor_delay_ms,
                         "delay from the hand's force to the loop; as identified, else 1, or the cell's "
                         "period if that is longer")
            ->check(NumberWithin(0, 50)));
  stand(sub_->add_option("--grip", options_.human_grip_N_per_m,
                         "stiffest grip, in N/m, for which the tool has to stay light")
            ->check(NumberWithin(100, 50e3)));
  stand(sub_->add_option("--stiffest-grip", options_.stiffest_grip_N_per_m,
                         "stiffest grip, in N/m, that is examined")
            ->check(NumberWithin(100, 50e3)));
  sub_->add_option("--nodes", options_.dampings, "number of dampings in the map")
      ->check(NumberWithin(3, 100))
      ->capture_default_str();
  sub_->add_option("--threads", options_.threads, "number of threads; the result does not depend on it")
      ->check(NumberWithin(1, 256))
      ->capture_default_str();
  AddShardOption(*sub_, options_.sharding);
  sub_->footer(
      "The map is along one axis of the tool. Results stay in the folder: only what has changed is computed "
      "again.\n\n"
      "Exit code 1: the verdict is bad, or a file could not be written\n\nExamples:\n  osteon tune demo\n  "
      "osteon tune demo --plan acetabulum\n  "
      "osteon tune my_cell.yaml --identified identify/identified.yaml\n  "
      "osteon tune config/cells/demo.yaml --margin 1.5 --out "
      "my_gains\n"
      "  osteon run demo --simulated --gains tune/gains.yaml");
}

int TuneCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  TakeInvocation(invocation, options_.sharding);
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return session::Fail("tune", found.error());
  options_.cell = *found;
  if (!plan_.empty()) {
    const auto plan = FindPlan(invocation.config_root, plan_);
    if (!plan) return session::Fail("tune", plan.error());
    options_.plan = *plan;
  }
  return studies::RunTune(options_);
}

}  // namespace

void AddTuneCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<TuneCommand>(app)); }

}  // namespace osteon::app
