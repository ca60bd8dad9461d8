#include "app/replay_command.h"

#include "app/cell_file.h"
#include "app/exit_code.h"

namespace osteon::app {

ReplayCommand::ReplayCommand(CLI::App& app)
    : sub_(app.add_subcommand("replay", "runs the controller again on what a recording says it was given")) {
  sub_->add_option("recording", options_.recording, "an .mcap file that a run has left; a torn one will do")
      ->required()
      ->check(CLI::ExistingFile);
  sub_->add_option(
      "--cell", cell_,
      "a cell's YAML file or name instead of the recorded configuration: what would have been otherwise");
  sub_->add_option("--json", options_.json, "write the result there");
  sub_->footer(
      "The recording holds every input of the servo loop and the configuration: nothing else is read.\n"
      "Exit code 1: a bit differs, or a tick could not be run again.\n\n"
      "Examples:\n  osteon replay demo_out/recording.mcap\n"
      "  osteon replay demo_out/recording.mcap --json replay.json\n"
      "  osteon replay demo_out/recording.mcap --cell softer.yaml");
}

int ReplayCommand::Run(const std::filesystem::path& config_root) {
  if (!cell_.empty()) {
    const auto found = FindCell(config_root, cell_);
    if (!found) return Fail("replay", "--cell " + found.error());
    options_.cell = *found;
  }
  return RunReplay(options_);
}

}  // namespace osteon::app
