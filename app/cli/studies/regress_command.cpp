#include "app/cli/studies/studies.h"

#include <string>

#include "app/cli/studies/shard_option.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "studies/regress/regress.h"
#include "studies/sweep/sweep.h"

namespace osteon::app {
namespace {

class RegressCommand final : public Subcommand {
 public:
  explicit RegressCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::RegressOptions options_;
  std::string sweep_;  ///< empty: scenarios against their golden traces
};

RegressCommand::RegressCommand(CLI::App& app) : Subcommand(AddStudy(app, "regress")) {
  auto* scenarios =
      sub_->add_option(
              "scenarios", options_.scenarios,
              "names under scenarios/, YAML files or folders of them; without any, all of scenarios/")
          ->type_name("SCENARIO");
  auto* junit = sub_->add_option("--junit", options_.junit, "write the verdicts there, for a CI server")
                    ->type_name("FILE");
  auto* sweep =
      sub_->add_option(
              "--sweep", sweep_,
              "instead: a scenario with many values, drawn or listed, by a name under sweeps/ or a file; "
              "its figures, quantiles and plots in sweep.html (docs/sharding.md)")
          ->type_name("SWEEP")
          ->excludes(scenarios)
          ->excludes(junit);
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->add_option("--out", options_.out,
                   "folder for regress.html, written if something differs, or sweep.html and sweep.csv")
      ->type_name("FOLDER")
      ->capture_default_str();
  auto* exact = sub_->add_flag(
      "--exact", options_.exact,
      "also fail on a different bit; for the compiler and processor that made the golden traces");
  auto* set =
      sub_->add_option(
              "--set", options_.set,
              "value in place of the one in every scenario's cell file, e.g. limits.max_force_N=150; may be "
              "given several times")
          ->type_name("KEY=VALUE")
          ->expected(1)
          ->take_all();
  auto* update =
      sub_->add_flag("--update", options_.update,
                     "replace the golden traces of scenarios that differ, or whose files have changed");
  update->excludes(set);
  sweep->excludes(exact)->excludes(update);
  sub_->add_flag("--all", options_.all, "update all scenarios without naming them")->needs(update);
  sub_->add_option("--reason", options_.reason, "why the new traces are right; written into their heads");
  sub_->add_option("--jobs", options_.jobs,
                   "scenarios at a time; 0: one for each core. The result does not depend on it")
      ->check(NumberWithin(0, 1024))
      ->capture_default_str();
  AddShardOption(*sub_, options_.sharding)->excludes(update);
  sub_->add_option(
          "--device", options_.device,
          "for scenarios of the engine vulkan: part of the device's name, as `osteon doctor` lists it")
      ->type_name("NAME");
  sub_->footer(
      "A scenario passes if every sampled quantity is within its tolerance of the golden trace and every "
      "event comes at its tick. The table also tells whether every bit is the same: another compiler or "
      "processor may round differently.\n\n"
      "Exit code 1: a scenario differs, cannot be run, or has no golden trace; a run of a sweep cannot be "
      "made\n\n"
      "Examples:\n  osteon regress\n  osteon regress --junit regress.xml --json regress.json\n"
      "  osteon regress reaming_lbr my_scenarios/wall.yaml\n"
      "  osteon regress reaming_lbr --set coupling.stiffness_N_per_mm=20.2\n"
      "  osteon regress --sweep trembling_hand --json sweep.json\n"
      "  osteon regress reaming_lbr --update --reason \"the reamer's mass was weighed anew\"");
}

int RegressCommand::Run(const Invocation& invocation) {
  options_.config_root = invocation.config_root;
  options_.command_line = invocation.command_line;
  TakeInvocation(invocation, options_.sharding);
  if (sweep_.empty()) return studies::RunRegress(options_);
  return studies::RunSweep({.config_root = invocation.config_root,
                            .sweep = sweep_,
                            .out = options_.out,
                            .json = options_.json,
                            .jobs = options_.jobs,
                            .device = options_.device,
                            .set = options_.set,
                            .command_line = options_.command_line,
                            .sharding = options_.sharding});
}

}  // namespace

void AddRegressCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<RegressCommand>(app));
}

}  // namespace osteon::app
