#include "app/cli/surgical_plan_command.h"

#include "app/cli/cell_file.h"
#include "app/cli/plan_file.h"
#include "app/cli/study_commands.h"
#include "session/process/exit_code.h"

namespace osteon::app {

SurgicalPlanCommand::SurgicalPlanCommand(CLI::App& app) : sub_(AddStudy(app, "surgical-plan")) {
  sub_->add_option("plan", plan_, "a name under plans/, or a plan's YAML file")
      ->type_name("PLAN")
      ->required();
  sub_->add_option("--cell", cell_, "also hold the plan against this cell: its bone and its depth limit")
      ->type_name("CELL");
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Exit code 2: the plan is refused; the error names file and line\n\n"
      "Examples:\n  osteon surgical-plan acetabulum\n"
      "  osteon surgical-plan acetabulum --cell demo --json plan.json");
}

int SurgicalPlanCommand::Run(const std::filesystem::path& config_root) {
  const auto plan = FindPlan(config_root, plan_);
  if (!plan) return Fail("surgical-plan", plan.error());
  options_.plan = *plan;
  if (!cell_.empty()) {
    const auto cell = FindCell(config_root, cell_);
    if (!cell) return Fail("surgical-plan", "--cell " + cell.error());
    options_.cell = *cell;
  }
  return RunSurgicalPlan(options_);
}

}  // namespace osteon::app
