#include "app/cli/studies/studies.h"

#include <string>

#include <fmt/format.h>

#include "app/cli/usage/cell_file.h"
#include "app/cli/usage/study_commands.h"
#include "app/cli/usage/tool_choice.h"
#include "app/cli/usage/usage.h"
#include "session/process/exit_code.h"
#include "session/setup/cell_setup.h"
#include "session/setup/engine_choice.h"
#include "studies/plan/plan_result.h"

namespace osteon::app {
namespace {

class PlanCommand final : public Subcommand {
 public:
  explicit PlanCommand(CLI::App& app);
  [[nodiscard]] int Run(const Invocation& invocation) override;

 private:
  studies::PlanOptions options_;
  double error_mm_{0.0};
  std::string cell_, tool_, cup_, engine_{"auto"}, device_;
};

PlanCommand::PlanCommand(CLI::App& app) : Subcommand(AddStudy(app, "plan")) {
  sub_->add_option("scene", options_.choice.scene,
                   "a name under scenes/, or a scene's YAML file; or a mesh (.stl, .obj, .ply) with --cup")
      ->type_name("SCENE")
      ->required();
  sub_->add_option("--cup", cup_,
                   "the mesh's cup, or the entry of a drill: centre, axis out of the bone, radius; mm")
      ->type_name("X,Y,Z,NX,NY,NZ,R");
  sub_->add_option("--scene", options_.choice.mesh_scene,
                   "scene whose bone the mesh replaces: gives tissue and cut; without it acetabulum")
      ->type_name("SCENE");
  sub_->add_option("--scale", options_.choice.scale, "mm for each unit of the mesh file")
      ->check(NumberWithin(1e-6, 1e6));
  sub_->add_option("--error-mm", error_mm_, "accepted mean depth error of a cut")
      ->check(NumberWithin(0.001, 5))
      ->required();
  sub_->add_option("--rate-hz", options_.request.rate_hz, "frames per second")
      ->check(NumberWithin(1, 100e3))
      ->required();
  sub_->add_option(
          "--cell", cell_,
          "the cell with tool, coupling and arm; without it the cell of the scene's name, or else demo")
      ->type_name("CELL");
  sub_->add_option("--tool", tool_,
                   "use this tool instead of the cell's: NAME or NAME:DIAMETER in mm; a name under tools/, "
                   "or a YAML file")
      ->type_name("TOOL");
  sub_->add_flag("--check", options_.check, "carry the plan out and measure what it predicts");
  AddEngineOption(*sub_, engine_, session::WallTimeEngineNames(), "the cutting engine that is timed");
  AddDeviceOption(*sub_, device_);
  sub_->add_option("--out", options_.out, "folder for plan.html")->type_name("FOLDER");
  sub_->add_option("--json", options_.json, "also write the plan there, as JSON")->type_name("FILE");
  sub_->footer(
      "The command first times two other packings on this machine.\n\n"
      "Exit code 1: error and rate cannot both be met (the plan says which was given up, and by how much), "
      "or --check measured something else than the plan promised\n\nExamples:\n"
      "  osteon plan acetabulum --error-mm 0.1 --rate-hz 1000\n"
      "  osteon plan molar --error-mm 0.03 --rate-hz 1000 --check --json plan.json\n"
      "  osteon plan thin_plate --tool twist_drill:3.2 --error-mm 0.05 --rate-hz 500\n"
      "  osteon plan hip.stl --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21 --error-mm 0.1 --rate-hz 500\n"
      "  osteon plan config/scenes/femoral_canal.yaml --error-mm 0.2 --rate-hz 2000 --device llvmpipe");
}

int PlanCommand::Run(const Invocation& invocation) {
  options_.command_line = invocation.command_line;
  options_.choice.config_root = invocation.config_root;
  options_.request.error_m = 1e-3 * error_mm_;
  options_.request.engine = session::ChooseEngine(engine_, device_);
  if (!cup_.empty()) {
    const auto site = session::ParseCup(cup_);
    if (!site) return session::Fail("plan", site.error());
    options_.choice.site = *site;
  }
  if (!cell_.empty()) {
    const auto found = FindCell(invocation.config_root, cell_);
    if (!found) return session::Fail("plan", "--cell " + found.error());
    options_.choice.cell = *found;
  }
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, invocation.config_root);
    if (!parsed) return session::Fail("plan", parsed.error());
    options_.choice.tool = *parsed;
  }
  try {
    return studies::RunPlan(options_);
  } catch (const config::ToolSizeError& error) {
    return session::Fail("plan", fmt::format("--tool {}: {}", tool_, error.what()));
  } catch (const std::invalid_argument& error) {
    return session::Fail("plan", error.what());
  }
}

}  // namespace

void AddPlanCommand(CLI::App& app, Subcommands& all) { all.push_back(std::make_unique<PlanCommand>(app)); }

}  // namespace osteon::app
