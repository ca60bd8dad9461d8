#include "app/cli/subcommands.h"

#include <string>
#include <utility>

#include "app/cli/files/recorded_mesh_options.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/replay/export_recording.h"

namespace osteon::app {
namespace {

class ExportCommand final : public Subcommand {
 public:
  explicit ExportCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation&) override;

 private:
  session::ExportOptions options_;
  RecordedMeshOptions mesh_;
};

ExportCommand::ExportCommand(CLI::App& app)
    : Subcommand(app.add_subcommand(
          "export",
          "writes a recording as tables, its bone as a mesh, a copy that shows the bone in "
          "Foxglove, or recovers a torn one")) {
  sub_->add_option("recording", options_.recording, "the .mcap file of a run")
      ->type_name("FILE")
      ->required()
      ->check(CLI::ExistingFile);
  sub_->add_flag("--csv", options_.csv,
                 "write RECORDING_ticks.csv, _frames.csv and _events.csv; the default where no other file "
                 "is asked for");
  sub_->add_flag("--recover", options_.recover,
                 "write RECORDING_recovered.mcap with every complete message of a torn or damaged file");
  CLI::Option* surface =
      sub_->add_option("--surface", options_.surface,
                       "write the carved bone there as a closed mesh in mm: .stl, .ply or .obj")
          ->type_name("FILE");
  sub_->add_option("--at", options_.at_s,
                   "the bone at this time of the recording, in seconds (time_s of the tables); without it at "
                   "the end")
      ->check(NumberWithin(0.0, 86'400.0))
      ->needs(surface);
  sub_->add_option("--drop-pieces", options_.drop_below_mm3,
                   "leave out pieces of bone of fewer cubic millimetres that nothing holds: chips and pins")
      ->check(NumberWithin(0.0, 1e6))
      ->needs(surface);
  CLI::Option* foxglove =
      sub_->add_option("--foxglove", options_.foxglove,
                       "write a copy of the recording there that shows the carved bone in Foxglove and "
                       "Lichtblick: .mcap")
          ->type_name("FILE");
  sub_->add_option("--every", options_.every_s,
                   "seconds of the recording from one state of that bone to the next")
      ->check(NumberWithin(0.03, 3600.0))
      ->needs(foxglove)
      ->capture_default_str();
  mesh_.AddTo(*sub_);
  sub_->add_option("--out", options_.out, "folder for the files; without it the recording's own")
      ->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon export demo_out/recording.mcap\n"
      "  osteon export demo_out/recording.mcap --out tables --json export.json\n"
      "  osteon export demo_out/recording.mcap --surface bone.stl --at 4.5\n"
      "  osteon export demo_out/recording.mcap --surface bone.stl --drop-pieces 1\n"
      "  osteon export demo_out/recording.mcap --foxglove with_bone.mcap\n"
      "  osteon export torn.mcap --recover\n  osteon export torn.mcap --recover --csv");
}

int ExportCommand::Run(const Invocation&) {
  session::ExportOptions options = options_;
  auto mesh = mesh_.Read();
  if (!mesh) return session::Fail("export", mesh.error());
  if (*mesh && options.surface.empty() && options.foxglove.empty())
    return session::Fail("export",
                         "--mesh: found neither --surface nor --foxglove, accepted with one of them");
  options.mesh = std::move(*mesh);
  return session::RunExport(options);
}

}  // namespace

void AddExportCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<ExportCommand>(app));
}

}  // namespace osteon::app
