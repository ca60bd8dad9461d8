#include "app/cell_commands.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/demo.h"
#include "app/fidelity_options.h"
#include "app/tool_choice.h"
#include "app/usage.h"

namespace osteon::app {

CellCommands::CellCommands(CLI::App& app)
    : cell_(app.add_subcommand("cell", "the simulated cell alone, on its real protocols and ports")),
      run_(app.add_subcommand("run", "operates a cell, real or simulated")) {
  const auto common = [this](CLI::App& sub) {
    sub.add_option("cell", name_, "a cell's YAML file, or a name under cells/")->required();
    sub.add_option("--tool", tool_, "NAME[:DIAMETER]: instead of the cell's; mm");
  };
  common(*cell_);
  cell_->add_option("--seconds", simulated_.seconds, "of what the operator does; without it the script's own")
      ->check(NumberWithin(kMinSeconds, kMaxSeconds));
  cell_
      ->add_option("--port", simulated_.port,
                   "the first of the cell's ports instead of its file's: FRI, PLC, two a CAN bus")
      ->check(PortNumber());
  cell_
      ->add_option("--cpu", simulated_.cpu,
                   "its real-time threads run on this CPU, everything else stays off it: the controller's")
      ->check(NumberWithin(0, rt::kMaxCpu));
  cell_->add_option("--json", simulated_.json, "write there at the end what the cell was");
  cell_->add_option(
      "--trace", simulated_.trace,
      "CSV file of each cycle of the arm while it runs: where the tool is, how fast, the hand's force");
  cell_->footer(
      "The arm, the force sensor, the reamer drive and the PLC, an operator at the handle and one at the "
      "buttons.\nAnother controller than Osteon's may be at the other end.\n\n"
      "Examples:\n  osteon cell demo\n  osteon cell config/cells/molar.yaml --json cell.json");

  common(*run_);
  run_->add_flag(
      "--simulated", operate_.simulated,
      "start the simulated cell as well, and its guard where it has one, in processes of their own");
  run_->add_option("--seconds", operate_.seconds, "of rendering; without it until Ctrl-C")
      ->check(NumberWithin(kMinSeconds, kMaxSeconds));
  run_->add_option("--wait", operate_.wait_s,
                   "seconds for the arm and all conditions of motion, until rendering begins")
      ->capture_default_str()
      ->check(NumberWithin(1, 86'400));
  run_->add_option(
          "--recover", operate_.recoveries,
          "begin again so often where the arm has left COMMANDING_ACTIVE, or was silent, and is back")
      ->check(NumberWithin(0, 1000));
  run_->add_option("--record", operate_.record,
                   "the recording, readable by `osteon export` and Foxglove; without it "
                   "run_DATE_TIME.mcap in the working folder. A name that an earlier run has is refused");
  run_->add_flag("--overwrite", operate_.overwrite,
                 "an earlier run's recording and pages of that name are replaced");
  run_->add_option(
          "--gains", operate_.gains,
          "YAML file laid over the cell's admittance and coupling, as `osteon tune` writes it; saved again "
          "while it runs, the gains go there within a second")
      ->check(CLI::ExistingFile);
  run_->add_option("--port", operate_.port, "as `osteon cell --port`; with --simulated 0 takes any free ones")
      ->check(PortNumber());
  run_->add_option("--cpu", operate_.cpu,
                   "the servo thread runs on this CPU, everything else stays off it; with --simulated the "
                   "cell's real-time threads share it")
      ->check(NumberWithin(0, rt::kMaxCpu));
  AddFidelityOptions(*run_, operate_.fidelity);
  run_->add_option("--device", operate_.device, "part of a Vulkan device's name (osteon doctor lists them)");
  run_->add_option("--json", operate_.json, "write the figures there");
  run_->footer(
      "Examples:\n  osteon run my_cell.yaml --record first.mcap\n  osteon run demo --simulated --seconds 10\n"
      "  osteon run demo --simulated --cpu 1\n"
      "  osteon cell demo &  osteon run demo --seconds 10");
}

int CellCommands::Run(const std::filesystem::path& config_root) {
  const char* name = cell_->parsed() ? "cell" : "run";
  const auto refuse = [name](const std::string& what) {
    fmt::print(stderr, "osteon {}: {}\n", name, what);
    return 2;
  };
  const auto found = FindCell(config_root, name_);
  if (!found) return refuse(found.error());
  std::optional<config::ToolChoice> tool;
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, config_root);
    if (!parsed) return refuse(parsed.error());
    tool = *parsed;
  }
  if (operate_.port == 0 && !operate_.simulated)
    return refuse("--port: found 0, accepted a port, or 0 with --simulated");
  simulated_.cell = operate_.cell = *found;
  simulated_.tool = operate_.tool = tool;
  try {
    return cell_->parsed() ? RunSimulatedCell(simulated_) : RunOperate(operate_);
  } catch (const config::ToolSizeError& error) {
    return refuse(fmt::format("--tool {}: {}", tool_, error.what()));
  }
}

}  // namespace osteon::app
