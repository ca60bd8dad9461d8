#include "app/cli/studies/studies.h"

#include <optional>
#include <string>

#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "studies/soak/soak.h"
#include "studies/soak/wall_soak.h"

namespace osteon::app {
namespace {

class SoakCommand final : public Subcommand {
 public:
  explicit SoakCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::SoakOptions options_;
  bool wall_{false};
  std::optional<double> hours_;
};

SoakCommand::SoakCommand(CLI::App& app) : Subcommand(AddStudy(app, "soak")) {
  sub_->add_flag("--wall", wall_,
                 "real processes in wall time instead: cell, guard, controller, three pages");
  sub_->add_option("--hours", hours_,
                   "virtual time to simulate, or wall time to run, in hours; without it 8, with --wall 2")
      ->check(NumberWithin(0.001, 100));
  sub_->add_option("--seed", options_.seed, "draws the episodes: their reamers, hands and faults")
      ->check(NumberWithin(0, 1e9))
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "also write the episodes there, as JSON")->type_name("FILE");
  sub_->add_option("--out", options_.out, "folder for soak.html")->type_name("FOLDER");
  sub_->footer(
      "Runs the simulated cell in virtual time, one seeded episode after the other: reaming, lost and late "
      "datagrams, pauses, recoveries, and parts that fall silent and are started again. Every tenth episode "
      "is the same, and must have the same bits (docs/soak.md).\n\n"
      "--wall runs the cell as it is operated: osteon cell, osteon guard and osteon run as processes, with "
      "pages at the console. The seed draws lost datagrams, pauses, halts, changes of tool, and what is "
      "killed and started again.\n\n"
      "Exit code 1: a fault that was not injected, a balance that does not close, a recording with a gap, "
      "memory that grows, or a file that could not be written\n\n"
      "Examples:\n  osteon soak --out soak\n  osteon soak --hours 0.1 --seed 7 --json soak.json\n"
      "  osteon soak --wall --hours 2 --out soak_wall");
}

int SoakCommand::Run(const Invocation& invocation) {
  options_.config_root = invocation.config_root;
  options_.command_line = invocation.command_line;
  constexpr double kVirtual_h = 8.0, kWall_h = 2.0;  // durations without --hours
  options_.hours = hours_.value_or(wall_ ? kWall_h : kVirtual_h);
  return wall_ ? studies::RunWallSoak(options_) : studies::RunSoak(options_);
}

}  // namespace

void AddSoakCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<SoakCommand>(app)); }

}  // namespace osteon::app
