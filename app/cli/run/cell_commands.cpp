#include "app/cli/subcommands.h"

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "app/cli/run/procedure_options.h"
#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/console_option.h"
#include "app/cli/usage/fidelity_options.h"
#include "app/cli/usage/tool_choice.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/run/demo.h"
#include "session/run/operate.h"
#include "session/run/simulated_cell_run.h"
#include "session/setup/engine_choice.h"

namespace osteon::app {
namespace {

// `osteon cell` (sub_) runs the simulated cell, `osteon run` (run_) the controller of a cell.
class CellCommands final : public Subcommand {
 public:
  explicit CellCommands(CLI::App& app);
  [[nodiscard]] bool asked() const override { return sub_->parsed() || run_->parsed(); }
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::SimulatedCellOptions simulated_;
  session::OperateOptions operate_;
  ProcedureOptions procedure_, cell_procedure_;  // options of a procedure for `run` and for `cell`
  std::string name_, tool_;
  std::filesystem::path identified_;
  CLI::App* run_;
};

CellCommands::CellCommands(CLI::App& app)
    : Subcommand(
          app.add_subcommand("cell", "runs the simulated cell alone, on its real protocols and ports")),
      run_(app.add_subcommand("run", "operates a cell, real or simulated")) {
  const auto add_common_options = [this](CLI::App& sub) {
    sub.add_option("cell", name_, "a name under cells/, or a cell's YAML file")
        ->type_name("CELL")
        ->required();
    sub.add_option("--tool", tool_,
                   "use this tool instead of the cell's: NAME or NAME:DIAMETER in mm; a name under tools/, "
                   "or a YAML file")
        ->type_name("TOOL");
    AddIdentifiedOption(sub, identified_);
  };
  add_common_options(*sub_);
  cell_procedure_.Add(*sub_, false);
  sub_->add_option("--seconds", simulated_.seconds,
                   "seconds of the operator's actions; without it as long as the script")
      ->check(NumberWithin(session::kMinSeconds, session::kMaxSeconds));
  sub_->add_option("--port", simulated_.port,
                   "first of the cell's ports, instead of the one in its file: FRI, PLC, then two for each "
                   "CAN bus; 0: any free ports, which it names")
      ->check(PortNumber());
  sub_->add_option("--cpu", simulated_.cpu,
                   "CPU of the cell's real-time threads; everything else stays off it")
      ->check(NumberWithin(0, rt::kMaxCpu));
  sub_->add_option("--json", simulated_.json, "write a summary of the cell there at the end, as JSON")
      ->type_name("FILE");
  sub_->add_option("--trace", simulated_.trace,
                   "write each cycle of the arm to a CSV file during the run: tool pose and velocity, the "
                   "hand's force")
      ->type_name("FILE");
  AddConsoleOption(*sub_, simulated_.console);
  sub_->footer(
      "Simulates the arm, the force sensor, the reamer drive, the PLC, an operator at the handle and one at "
      "the buttons. The controller at the other end need not be Osteon's.\n\n"
      "Exit code 1: a file could not be written\n\n"
      "Examples:\n  osteon cell demo\n  osteon cell config/cells/molar.yaml --json cell.json");

  add_common_options(*run_);
  run_->add_flag("--simulated", operate_.simulated,
                 "start the simulated cell as well, and its guard if it has one, each as a process");
  procedure_.Add(*run_, true);
  run_->add_option("--seconds", operate_.seconds, "seconds of rendering; without it until Ctrl-C")
      ->check(NumberWithin(session::kMinSeconds, session::kMaxSeconds));
  run_->add_option("--wait", operate_.wait_s, "seconds to wait for the arm and for all conditions of motion")
      ->capture_default_str()
      ->check(NumberWithin(1, 86'400));
  run_->add_option("--recover", operate_.recoveries,
                   "how often rendering starts again after the arm left COMMANDING_ACTIVE or was silent, and "
                   "came back")
      ->check(NumberWithin(0, 1000));
  run_->add_option("--record", operate_.record,
                   "the recording, for `osteon export` and Foxglove; without it run_DATE_TIME.mcap in the "
                   "working folder. An existing name is refused")
      ->type_name("FILE");
  run_->add_flag("--overwrite", operate_.overwrite,
                 "replace an earlier recording of that name and its pages");
  run_->add_option("--gains", operate_.gains,
                   "YAML file that replaces the cell's admittance and coupling, as `osteon tune` writes it; "
                   "if you save it during the run, its gains apply within a second")
      ->type_name("FILE")
      ->check(CLI::ExistingFile);
  run_->add_option("--port", operate_.port, "as `osteon cell --port`; 0 with --simulated: any free ports")
      ->check(PortNumber());
  run_->add_option("--cpu", operate_.cpu,
                   "CPU of the servo thread; everything else stays off it. With --simulated the cell's "
                   "real-time threads share it")
      ->check(NumberWithin(0, rt::kMaxCpu));
  AddFidelityOptions(*run_, operate_.fidelity);
  AddEngineOption(*run_, operate_.engine, session::WallTimeEngineNames(), "the cutting engine",
                  "; cpu: one thread, no GPU");
  AddDeviceOption(*run_, operate_.device);
  run_->add_option("--surface", operate_.surface,
                   "write the carved bone there as a closed mesh in mm: .stl, .ply or .obj")
      ->type_name("FILE");
  AddConsoleOption(*run_, operate_.console);
  AddTuneOption(*run_, operate_.tune);
  AddFoxgloveOption(*run_, operate_.foxglove);
  AddRecordBoneOption(*run_, operate_.bone_state_s);
  AddAtFaultOption(*run_, "hold with --console and no --seconds, else end",
                   [this](bool hold) { operate_.hold_at_fault = hold; });
  run_->add_option("--json", operate_.json, "also write the figures there, as JSON")->type_name("FILE");
  run_->footer(
      "Exit code 1: a fault ended the run or was recovered from by an operator, the arm did not come in "
      "time, or a file could not be written\n\n"
      "Examples:\n  osteon run my_cell.yaml --record first.mcap\n  osteon run demo --simulated --seconds 10\n"
      "  osteon run demo --simulated --cpu 1\n"
      "  osteon run demo --simulated --plan acetabulum --session first_hip --seconds 60\n"
      "  osteon cell demo &  osteon run demo --seconds 10");
}

int CellCommands::Run(const Invocation& invocation) {
  operate_.command_line = invocation.command_line;
  const char* name = sub_->parsed() ? "cell" : "run";
  const auto refuse = [name](const std::string& what) { return session::Fail(name, what); };
  const auto found = FindCell(invocation.config_root, name_);
  if (!found) return refuse(found.error());
  std::optional<config::ToolChoice> tool;
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, invocation.config_root);
    if (!parsed) return refuse(parsed.error());
    tool = *parsed;
  }
  if (operate_.port == 0 && !operate_.simulated)
    return refuse("--port: found 0, accepted a port, or 0 with --simulated");
  session::ProcedureChoice cell_choice;
  if (const std::string wrong = cell_procedure_.ReadInto(invocation.config_root, cell_choice); !wrong.empty())
    return refuse(wrong);
  simulated_.plan = cell_choice.plan;
  simulated_.hand = cell_choice.hand;
  if (const std::string wrong = procedure_.ReadInto(invocation.config_root, operate_.procedure);
      !wrong.empty())
    return refuse(wrong);
  if (procedure_.asked()) {
    if (tool && tool->diameter_m) return refuse("--tool " + tool_ + kSizeWithPlan);
    if (operate_.procedure.session.empty())
      return refuse(
          "--plan: found no --session, accepted with it: the folder that keeps recordings and states");
    if (!operate_.record.empty())
      return refuse("--record: found with --plan, accepted without: the session's folder has the recordings");
  }
  simulated_.cell = operate_.cell = *found;
  simulated_.tool = operate_.tool = tool;
  simulated_.identified = operate_.identified = identified_;
  try {
    return sub_->parsed() ? session::RunSimulatedCell(simulated_) : session::RunOperate(operate_);
  } catch (const config::ToolSizeError& error) {
    return refuse(fmt::format("--tool {}: {}", tool_, error.what()));
  }
}

}  // namespace

void AddCellCommands(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<CellCommands>(app)); }

}  // namespace osteon::app
