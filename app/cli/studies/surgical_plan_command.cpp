#include "app/cli/studies/studies.h"

#include <string>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/plan_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "studies/assess/surgical_plan_result.h"

namespace osteon::app {
namespace {

class SurgicalPlanCommand final : public Subcommand {
 public:
  explicit SurgicalPlanCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::SurgicalPlanOptions options_;
  std::string plan_, cell_, mesh_;
  double scale_{1.0};
};

SurgicalPlanCommand::SurgicalPlanCommand(CLI::App& app) : Subcommand(AddStudy(app, "surgical-plan")) {
  sub_->add_option("plan", plan_, "a name under plans/, or a plan's YAML file")
      ->type_name("PLAN")
      ->required();
  sub_->add_option("--cell", cell_, "also hold the plan against this cell: its bone and its depth limit")
      ->type_name("CELL");
  CLI::Option* mesh = sub_->add_option("--mesh", mesh_, "the mesh of a plan that has the mesh's cup alone")
                          ->type_name("FILE")
                          ->check(CLI::ExistingFile);
  sub_->add_option("--scale", scale_, "mm for each unit of the mesh file")
      ->check(NumberWithin(1e-4, 1e4))
      ->needs(mesh)
      ->capture_default_str();
  sub_->add_option("--json", options_.json, "also write the figures there, as JSON")->type_name("FILE");
  sub_->footer(
      "Exit code 2: the plan is refused; the error names file and line\n\n"
      "Examples:\n  osteon surgical-plan acetabulum\n"
      "  osteon surgical-plan acetabulum --cell demo --json plan.json\n"
      "  osteon surgical-plan hip_bone_left --mesh hip_bone_left.obj");
}

int SurgicalPlanCommand::Run(const Invocation& invocation) {
  const auto plan = FindPlan(invocation.config_root, plan_);
  if (!plan) return session::Fail("surgical-plan", plan.error());
  options_.plan = *plan;
  if (!cell_.empty()) {
    const auto cell = FindCell(invocation.config_root, cell_);
    if (!cell) return session::Fail("surgical-plan", "--cell " + cell.error());
    options_.cell = *cell;
  }
  if (!mesh_.empty()) options_.mesh = session::MeshChoice{.file = mesh_, .scale = scale_};
  return studies::RunSurgicalPlan(options_);
}

}  // namespace

void AddSurgicalPlanCommand(CLI::App& app, Subcommands& all) {
  all.push_back(std::make_unique<SurgicalPlanCommand>(app));
}

}  // namespace osteon::app
