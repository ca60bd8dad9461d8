#include "app/cli/subcommands.h"

#include <string>
#include <utility>

#include "app/cli/files/recorded_mesh_options.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/replay/recorded_report.h"

namespace osteon::app {
namespace {

class ReportCommand final : public Subcommand {
 public:
  explicit ReportCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::RecordedReportOptions options_;
  RecordedMeshOptions mesh_;
};

ReportCommand::ReportCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("report", "makes the report of a recording")) {
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

int ReportCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  auto mesh = mesh_.Read();
  if (!mesh) return session::Fail("report", mesh.error());
  options_.mesh = std::move(*mesh);
  return session::RunRecordedReport(options_);
}

}  // namespace

void AddReportCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<ReportCommand>(app));
}

}  // namespace osteon::app
