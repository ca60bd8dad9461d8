#include "app/guard_command.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/tool_choice.h"
#include "app/usage.h"
#include "control/rt/realtime_thread.h"

namespace osteon::app {

GuardCommand::GuardCommand(CLI::App& app)
    : sub_(
          app.add_subcommand("guard", "the independent supervisor, in the line between arm and controller")) {
  sub_->add_option("cell", name_, "a cell's YAML file, or a name under cells/; with a section guard")
      ->required();
  sub_->add_option("--tool", tool_, "NAME[:DIAMETER]: as the controller was told; mm");
  sub_->add_option("--port", options_.port, "as `osteon cell --port`")->check(PortNumber());
  sub_->add_option("--cpu", options_.cpu, "the relay runs on this CPU, everything else of it stays off")
      ->check(NumberWithin(0, rt::kMaxCpu));
  sub_->add_option("--json", options_.json, "write there at the end what it did");
  sub_->footer(
      "The arm sends to the guard, which sends on to the controller, and answers back, as long as they keep "
      "the "
      "cell's\nlimits. It is no certified safety function.\n\n"
      "Exit code 1: a command was withheld, or the controller fell silent while the arm moved.\n\n"
      "Examples:\n  osteon guard my_cell.yaml --json guard.json\n"
      "  osteon cell my_cell.yaml &  osteon guard my_cell.yaml &  osteon run my_cell.yaml --seconds 10");
}

int GuardCommand::Run(const std::filesystem::path& config_root) {
  const auto refuse = [](const std::string& what) {
    fmt::print(stderr, "osteon guard: {}\n", what);
    return 2;
  };
  const auto found = FindCell(config_root, name_);
  if (!found) return refuse(found.error());
  options_.cell = *found;
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, config_root);
    if (!parsed) return refuse(parsed.error());
    options_.tool = *parsed;
  }
  try {
    return RunGuard(options_);
  } catch (const config::ToolSizeError& error) {
    return refuse(fmt::format("--tool {}: {}", tool_, error.what()));
  }
}

}  // namespace osteon::app
