#include "app/cli/subcommands.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/run/procedure_options.h"
#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/console_option.h"
#include "app/cli/usage/fidelity_options.h"
#include "app/cli/usage/tool_choice.h"
#include "app/cli/usage/usage.h"
#include "base/realtime_thread.h"
#include "config/reading/load.h"
#include "session/process/exit_code.h"
#include "session/run/demo.h"
#include "session/setup/cell_setup.h"
#include "session/setup/engine_choice.h"

namespace osteon::app {
namespace {

class DemoCommand final : public Subcommand {
 public:
  explicit DemoCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::DemoOptions options_;
  ProcedureOptions procedure_;
  std::string mesh_, cup_, tool_, cell_{"demo"};
  double scale_{1.0};
  CLI::Option* seconds_option_{nullptr};
  CLI::Option *mesh_option_{nullptr}, *cup_option_{nullptr}, *scale_option_{nullptr}, *tool_option_{nullptr};
};

DemoCommand::DemoCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("demo", "cuts bone on the simulated cell and leaves a report")) {
  seconds_option_ = sub_->add_option("--seconds", options_.seconds,
                                     "seconds of rendering (COMMANDING_ACTIVE); with a plan 15 for each "
                                     "reamer and 20 more for the last, 60 each for a novice");
  seconds_option_->check(NumberWithin(session::kMinSeconds, session::kMaxSeconds))->capture_default_str();
  sub_->add_option("--out", options_.out,
                   "folder for summary.json, report.html and recording.mcap; files of an earlier demo move "
                   "to earlier_DATE_TIME in it")
      ->type_name("FOLDER")
      ->capture_default_str();
  sub_->add_flag("--overwrite", options_.overwrite, "replace the files of an earlier demo in --out");
  mesh_option_ =
      sub_->add_option(
              "--mesh", mesh_,
              "a closed mesh instead of the scene's bone: STL, OBJ or PLY in mm, or a packing (.osp)")
          ->type_name("FILE");
  cup_option_ =
      sub_->add_option(
              "--cup", cup_,
              "cup of the mesh, or the circle where a drill enters: centre, axis out of the bone, radius; mm")
          ->type_name("X,Y,Z,NX,NY,NZ,R");
  scale_option_ = sub_->add_option("--scale", scale_, "mm for each unit of the mesh file");
  scale_option_->check(NumberWithin(1e-4, 1e4))->needs(mesh_option_)->capture_default_str();
  cup_option_->needs(mesh_option_);
  procedure_.Add(*sub_, true);
  sub_->add_flag("--virtual-time", options_.virtual_time,
                 "lockstep, as fast as the machine can; two runs give the same bits");
  sub_->add_option("--frame-ms", options_.frame_ms, "duration of a simulation frame in virtual time")
      ->default_str("2")
      ->check(NumberWithin(1, 100));
  sub_->add_option("--real-time-factor", options_.real_time_factor,
                   "virtual time passes at most this many times as fast as real time; without it as fast "
                   "as the machine can")
      ->check(NumberWithin(0.01, 1000));
  AddFidelityOptions(*sub_, options_.fidelity);
  AddDeviceOption(*sub_, options_.device);
  AddEngineOption(*sub_, options_.engine, session::EngineNames(), "the cutting engine",
                  "; cpu: one thread, no GPU; reference: plain double precision, slow, virtual time only");
  sub_->add_option("--cell", cell_, "a name under cells/, or a cell's YAML file")
      ->type_name("CELL")
      ->capture_default_str();
  tool_option_ = sub_->add_option("--tool", tool_,
                                  "use this tool instead of the cell's: NAME or NAME:DIAMETER in mm; a "
                                  "name under tools/, or a YAML file")
                     ->type_name("TOOL");
  AddIdentifiedOption(*sub_, options_.identified);
  sub_->add_option("--port", options_.port,
                   "first of the cell's ports, instead of the one in its file: FRI, PLC, then two for each "
                   "CAN bus; 0: any free ports")
      ->check(PortNumber());
  sub_->add_option("--cpu", options_.cpu,
                   "CPU of the servo thread and the simulated arm; everything else stays off it")
      ->check(NumberWithin(0, rt::kMaxCpu));
  AddConsoleOption(*sub_, options_.console);
  AddTuneOption(*sub_, options_.tune);
  AddFoxgloveOption(*sub_, options_.foxglove);
  AddRecordBoneOption(*sub_, options_.bone_state_s);
  AddAtFaultOption(*sub_, "end", [this](bool hold) { options_.hold_at_fault = hold; });
  sub_->add_option("--json", options_.json, "write a further copy of summary.json there")->type_name("FILE");
  sub_->add_option("--surface", options_.surface,
                   "write the carved bone there as a closed mesh in mm: .stl, .ply or .obj")
      ->type_name("FILE");
  sub_->add_option("--save-motion", options_.save_motion,
                   "write the tool's motion there (CSV), to be played again")
      ->type_name("FILE");
  sub_->footer(
      "Exit code 1: a fault ended the run, or a file could not be written\n\n"
      "Examples:\n  osteon demo\n  osteon demo --seconds 5 --out my_run\n  osteon demo --virtual-time\n"
      "  osteon demo --error-mm 0.05 --rate-hz 500\n"
      "  osteon demo --plan acetabulum --virtual-time\n"
      "  osteon demo --virtual-time --real-time-factor 1 --console 8470\n"
      "  osteon demo --mesh hip.obj --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21\n"
      "  osteon demo --cell molar --mesh tooth.obj --scale 0.041 --cup 0,0.5,8,0,0,1,1.75");
}

int DemoCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  const auto found = FindCell(invocation.config_root, cell_);
  if (!found) return session::Fail("demo", fmt::format("--cell {}", found.error()));
  options_.cell = *found;
  if (!options_.virtual_time && !session::KeepsUpWithWallTime(options_.engine))
    return session::Fail("demo", "--engine reference: found wall time, accepted with --virtual-time only");
  if (*tool_option_) {
    const auto parsed = ParseTool(tool_, invocation.config_root);
    if (!parsed) return session::Fail("demo", parsed.error());
    options_.tool = *parsed;
  }
  if (procedure_.asked()) {
    std::string wrong = procedure_.ReadInto(invocation.config_root, options_.procedure);
    if (wrong.empty() && *cup_option_)
      wrong = "--cup: found with --plan, accepted without: the plan has the cup of its mesh";
    if (wrong.empty() && options_.tool && options_.tool->diameter_m)
      wrong = "--tool " + tool_ + kSizeWithPlan;
    if (!wrong.empty()) return session::Fail("demo", wrong);
    options_.default_seconds = !*seconds_option_;
  }
  if (*mesh_option_) {
    options_.mesh = session::MeshChoice{.file = mesh_, .scale = scale_};
    std::string wrong = mesh_.empty() ? "--mesh: found no name, accepted a file" : "";
    if (*cup_option_) {
      const auto parsed = session::ParseCup(cup_);
      if (!parsed && wrong.empty()) wrong = parsed.error();
      if (parsed) options_.mesh->cup = *parsed;
    } else if (wrong.empty() && !procedure_.asked() && options_.mesh->file.extension() != ".osp") {
      wrong =
          fmt::format("--mesh {}: found no --cup, accepted with it (a packing file may have its own)", mesh_);
    }
    if (wrong.empty() && *scale_option_ && options_.mesh->file.extension() == ".osp")
      wrong = fmt::format("--scale: found with {}, accepted with a mesh: a packing is in mm", mesh_);
    if (!wrong.empty()) return session::Fail("demo", wrong);
  }
  try {
    return session::RunDemo(options_);
  } catch (const config::ToolSizeError& error) {
    return session::Fail("demo", fmt::format("--tool {}: {}", tool_, error.what()));
  }
}

}  // namespace

void AddDemoCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<DemoCommand>(app)); }

}  // namespace osteon::app
