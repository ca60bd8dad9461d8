#include "app/cli/files/report_command.h"

#include <utility>

#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"

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
  mesh_.AddTo(*sub_);
  sub_->footer(
      "Writes RECORDING_report.html, and the pages of the stops. The bone is cut again along the recorded "
      "motion, packed as the run packed it; a mesh that the cell names has to lie where it lay.\n\n"
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon report demo_out/recording.mcap\n  osteon report run.mcap --out pages --json "
      "run.json");
}

int ReportCommand::Run(const std::string& command_line) {
  options_.command_line = command_line;
  auto mesh = mesh_.Read();
  if (!mesh) return session::Fail("report", mesh.error());
  options_.mesh = std::move(*mesh);
  return session::RunRecordedReport(options_);
}

}  // namespace osteon::app
