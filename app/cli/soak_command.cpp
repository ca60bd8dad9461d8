#include "app/cli/soak_command.h"

#include "app/cli/study_commands.h"
#include "app/cli/usage.h"

namespace osteon::app {

SoakCommand::SoakCommand(CLI::App& app) : sub_(AddStudy(app, "soak")) {
  sub_->add_option("--hours", options_.hours, "virtual time to simulate, in hours")
      ->check(NumberWithin(0.001, 100))
      ->capture_default_str();
  sub_->add_option("--seed", options_.seed, "draws the episodes: their reamers, hands and faults")
      ->check(NumberWithin(0, 1e9))
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "also write the episodes there, as JSON")->type_name("FILE");
  sub_->add_option("--out", options_.out, "folder for soak.html")->type_name("FOLDER");
  sub_->footer(
      "Runs the simulated cell in virtual time, one seeded episode after the other: reaming, lost and late "
      "datagrams, pauses, recoveries, and parts that fall silent and are started again. Every tenth episode "
      "is "
      "the same, and must have the same bits (docs/soak.md).\n\n"
      "Exit code 1: a fault that was not injected, books that do not close, a recording with a gap, memory "
      "that "
      "grows, or a file that could not be written\n\n"
      "Examples:\n  osteon soak --out soak\n  osteon soak --hours 0.1 --seed 7 --json soak.json");
}

int SoakCommand::Run(const std::filesystem::path& config_root, const std::string& command_line) {
  options_.config_root = config_root;
  options_.command_line = command_line;
  return studies::RunSoak(options_);
}

}  // namespace osteon::app
