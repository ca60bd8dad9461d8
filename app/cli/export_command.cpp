#include "app/cli/export_command.h"

namespace osteon::app {

ExportCommand::ExportCommand(CLI::App& app)
    : sub_(app.add_subcommand("export", "writes a recording as tables, or recovers a torn one")) {
  sub_->add_option("recording", options_.recording, "the .mcap file of a run")
      ->type_name("FILE")
      ->required()
      ->check(CLI::ExistingFile);
  sub_->add_flag("--csv", options_.csv,
                 "write RECORDING_ticks.csv, _frames.csv and _events.csv; the default without --recover");
  sub_->add_flag("--recover", options_.recover,
                 "write RECORDING_recovered.mcap with every complete message of a torn or damaged file");
  sub_->add_option("--out", options_.out, "folder for the files; without it the recording's own")
      ->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon export demo_out/recording.mcap\n"
      "  osteon export demo_out/recording.mcap --out tables --json export.json\n"
      "  osteon export torn.mcap --recover\n  osteon export torn.mcap --recover --csv");
}

}  // namespace osteon::app
