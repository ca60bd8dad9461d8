#include "app/cli/subcommands.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/tool_choice.h"
#include "app/cli/usage/usage.h"
#include "base/realtime_thread.h"
#include "session/guard/guard.h"
#include "session/process/exit_code.h"

namespace osteon::app {
namespace {

class GuardCommand final : public Subcommand {
 public:
  explicit GuardCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  session::GuardOptions options_;
  std::string name_, tool_;
};

GuardCommand::GuardCommand(CLI::App& app)
    : Subcommand(app.add_subcommand("guard", "runs the independent supervisor between arm and controller")) {
  sub_->add_option("cell", name_, "a name under cells/, or a cell's YAML file; its file has a section guard")
      ->type_name("CELL")
      ->required();
  sub_->add_option("--tool", tool_, "the tool that the controller was told: NAME or NAME:DIAMETER in mm")
      ->type_name("TOOL");
  sub_->add_option("--port", options_.port, "as `osteon cell --port`")->check(PortNumber());
  sub_->add_option("--cpu", options_.cpu, "CPU of the relay; everything else stays off it")
      ->check(NumberWithin(0, rt::kMaxCpu));
  sub_->add_option("--json", options_.json, "write a summary there at the end, as JSON")->type_name("FILE");
  sub_->footer(
      "The guard passes the arm's messages on to the controller, and the controller's commands on to the arm "
      "as long as they keep the cell's limits. It is not a certified safety function.\n\n"
      "Exit code 1: a command was withheld, or the controller fell silent while the arm moved\n\n"
      "Examples:\n  osteon guard my_cell.yaml --json guard.json\n"
      "  osteon cell my_cell.yaml &\n  osteon guard my_cell.yaml &\n  osteon run my_cell.yaml --seconds 10");
}

int GuardCommand::Run(const Invocation& invocation) {
  const auto refuse = [](const std::string& what) { return session::Fail("guard", what); };
  const auto found = FindCell(invocation.config_root, name_);
  if (!found) return refuse(found.error());
  options_.cell = *found;
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, invocation.config_root);
    if (!parsed) return refuse(parsed.error());
    options_.tool = *parsed;
  }
  try {
    return session::RunGuard(options_);
  } catch (const config::ToolSizeError& error) {
    return refuse(fmt::format("--tool {}: {}", tool_, error.what()));
  }
}

}  // namespace

void AddGuardCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<GuardCommand>(app)); }

}  // namespace osteon::app
