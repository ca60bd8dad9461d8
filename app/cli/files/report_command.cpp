#include "app/cli/files/report_command.h"

namespace osteon::app {

ReportCommand::ReportCommand(CLI::App& app)
    : sub_(app.add_subcommand("report", "makes the report of a recording")) {
  sub_->add_option("recording", options_.recording, "the .mcap file of a run")
      ->type_name("FILE")
      ->required()
      ->check(CLI::ExistingFile);
  sub_->add_option("--out", options_.out, "folder for the pages; without it the recording's own")
      ->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Writes RECORDING_report.html, and the pages of the stops. The bone is cut again along the recorded "
      "motion, packed as its scene says; a recorded mesh has to lie where it lay.\n\n"
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon report demo_out/recording.mcap\n  osteon report run.mcap --out pages --json "
      "run.json");
}

int ReportCommand::Run(const std::string& command_line) {
  options_.command_line = command_line;
  return session::RunRecordedReport(options_);
}

}  // namespace osteon::app
