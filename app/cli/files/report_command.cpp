#include "app/cli/files/report_command.h"

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
  CLI::Option* mesh =
      sub_->add_option("--mesh", mesh_.file,
                       "the bone's file, where the run's bone was of --mesh: it is not in the recording")
          ->type_name("FILE")
          ->check(CLI::ExistingFile);
  sub_->add_option("--cup", cup_, "the run's --cup: centre, axis out of the bone, radius; mm")
      ->type_name("X,Y,Z,NX,NY,NZ,R")
      ->needs(mesh);
  sub_->add_option("--scale", mesh_.scale, "mm for each unit of the mesh file")
      ->check(NumberWithin(1e-4, 1e4))
      ->needs(mesh)
      ->capture_default_str();
  sub_->footer(
      "Writes RECORDING_report.html, and the pages of the stops. The bone is cut again along the recorded "
      "motion, packed as the run packed it; a mesh that the cell names has to lie where it lay.\n\n"
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon report demo_out/recording.mcap\n  osteon report run.mcap --out pages --json "
      "run.json");
}

int ReportCommand::Run(const std::string& command_line) {
  options_.command_line = command_line;
  if (!mesh_.file.empty()) {
    options_.mesh = mesh_;
    if (!cup_.empty()) {
      const auto cup = session::ParseCup(cup_);
      if (!cup) return session::Fail("report", cup.error());
      options_.mesh->cup = *cup;
    }
  }
  return session::RunRecordedReport(options_);
}

}  // namespace osteon::app
