#include "app/export_command.h"

namespace osteon::app {

ExportCommand::ExportCommand(CLI::App& app)
    : sub_(app.add_subcommand("export", "a recording as tables; a whole one of a torn one")) {
  sub_->add_option("recording", options_.recording, "an .mcap file that a run has left")
      ->required()
      ->check(CLI::ExistingFile);
  sub_->add_flag("--csv", options_.csv,
                 "RECORDING_ticks.csv, _frames.csv, _events.csv (also without any option)");
  sub_->add_flag("--recover", options_.recover,
                 "RECORDING_recovered.mcap: every complete message of a file that is torn or damaged");
  sub_->add_option("--out", options_.out, "folder for them; without it the recording's own");
  sub_->add_option("--json", options_.json, "write there what was done");
  sub_->footer(
      "Examples:\n  osteon export demo_out/recording.mcap\n"
      "  osteon export demo_out/recording.mcap --out tables --json export.json\n"
      "  osteon export torn.mcap --recover\n  osteon export torn.mcap --recover --csv");
}

}  // namespace osteon::app
