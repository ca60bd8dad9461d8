#include "app/plan_command.h"

#include <fmt/format.h>

#include "app/cell_file.h"
#include "app/cell_setup.h"
#include "app/exit_code.h"
#include "app/tool_choice.h"
#include "app/usage.h"

namespace osteon::app {
PlanCommand::PlanCommand(CLI::App& app)
    : sub_(app.add_subcommand("plan", "the coarsest model of a scene that has an error and a rate")) {
  PlanOptions& o = options_;
  sub_->add_option("scene", o.choice.scene,
                   "a scene's YAML file, or a name under scenes/; or a mesh (.stl, .obj, .ply) with --cup")
      ->required();
  sub_->add_option("--cup", cup_, "X,Y,Z,NX,NY,NZ,R: a mesh's site, as a cup or entry; mm");
  sub_->add_option("--scene", o.choice.mesh_scene,
                   "a mesh takes this scene's place: its tissue and its cut (acetabulum)");
  sub_->add_option("--scale", o.choice.scale, "millimetres to a unit of the mesh file")
      ->check(NumberWithin(1e-6, 1e6));
  sub_->add_option("--error-mm", error_mm_, "mean depth that a cut may be off the tool's sweep")
      ->check(NumberWithin(0.001, 5))
      ->required();
  sub_->add_option("--rate-hz", o.request.rate_hz, "frames a second")
      ->check(NumberWithin(1, 100e3))
      ->required();
  sub_->add_option(
      "--cell", cell_,
      "tool, coupling and arm: a cell's YAML file or name; without it the cell of the scene's own name, "
      "or else demo");
  sub_->add_option("--tool", tool_,
                   "NAME[:DIAMETER]: instead of the cell's; a name under tools/, or a YAML file; mm");
  sub_->add_flag("--check", o.check, "carry the plan out, and measure what it predicts");
  sub_->add_option("--device", o.request.device, "part of a Vulkan device's name (osteon doctor lists them)");
  sub_->add_option("--json", o.json, "write the plan there");
  sub_->footer(
      "Times two other packings on this machine first. Exit code 1: error and rate can't both be had (the "
      "plan says "
      "which\none it gave up, and by how much), or --check measured something else than was "
      "promised.\n\nExamples:\n"
      "  osteon plan acetabulum --error-mm 0.1 --rate-hz 1000\n"
      "  osteon plan molar --error-mm 0.03 --rate-hz 1000 --check --json plan.json\n"
      "  osteon plan thin_plate --tool twist_drill:3.2 --error-mm 0.05 --rate-hz 500\n"
      "  osteon plan hip.stl --cup 8.8,-131.9,517.9,-0.983,-0.175,0.052,21 --error-mm 0.1 --rate-hz 500\n"
      "  osteon plan config/scenes/femoral_canal.yaml --error-mm 0.2 --rate-hz 2000 --device llvmpipe");
}

int PlanCommand::Run(const std::filesystem::path& config_root) {
  options_.choice.config_root = config_root;
  options_.request.error_m = 1e-3 * error_mm_;
  if (!cup_.empty()) {
    const auto site = ParseCup(cup_);
    if (!site) return Fail("plan", site.error());
    options_.choice.site = *site;
  }
  if (!cell_.empty()) {
    const auto found = FindCell(config_root, cell_);
    if (!found) return Fail("plan", "--cell " + found.error());
    options_.choice.cell = *found;
  }
  if (!tool_.empty()) {
    const auto parsed = ParseTool(tool_, config_root);
    if (!parsed) return Fail("plan", parsed.error());
    options_.choice.tool = *parsed;
  }
  try {
    return RunPlan(options_);
  } catch (const config::ToolSizeError& error) {
    return Fail("plan", fmt::format("--tool {}: {}", tool_, error.what()));
  } catch (const std::invalid_argument& error) {
    return Fail("plan", error.what());
  }
}

}  // namespace osteon::app
