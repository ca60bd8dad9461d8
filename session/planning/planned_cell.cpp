#include "session/planning/planned_cell.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::session {
namespace {

// Returns the demands on the packing, from the command line and the scene; nothing if there are none.
std::optional<simulation::FidelityRequest> RequestedFidelity(const CellSetup& setup,
                                                             const FidelityChoice& choice) {
  std::optional<simulation::FidelityRequest> asked = setup.config.scene.fidelity;
  if (choice.as_packed) return std::nullopt;
  if (!asked && (choice.error_m || choice.rate_hz)) asked.emplace();
  if (choice.error_m) asked->error_m = *choice.error_m;
  if (choice.rate_hz) asked->rate_hz = *choice.rate_hz;
  return asked;
}

}  // namespace

tl::expected<void, std::string> PackCell(CellSetup& setup, const FidelityChoice& choice,
                                         const EngineChoice& engine, bool timed,
                                         const std::function<void(const std::string&)>& say) {
  if (!setup.solid && (choice.error_m || choice.rate_hz))
    return tl::make_unexpected(
        fmt::format("--{}: found with a packing that was loaded, accepted with a scene or a mesh",
                    choice.error_m ? "error-mm" : "rate-hz"));
  const auto asked = RequestedFidelity(setup, choice);
  if (!setup.solid || !asked) {
    PackAsScene(setup);
    return {};
  }
  const simulation::SceneSolid solid{.name = setup.bone.name, .solid = setup.solid, .site = setup.bone.site};
  auto planned = std::make_shared<PlannedCell>();
  planned->request = {
      .error_m = asked->error_m, .rate_hz = asked->rate_hz, .engine = engine, .rounds = 1, .timed = timed};
  try {
    planned->scene = MakePlanScene(solid, setup.config.scene, setup.config, setup.cell_name);
  } catch (const std::invalid_argument& error) {
    return tl::make_unexpected(std::string(error.what()));
  }
  auto plan = MakePlan(planned->scene, planned->request, say);
  if (!plan) return tl::make_unexpected(plan.error());
  planned->plan = std::move(*plan);
  setup.bone =
      simulation::SceneBone(solid, setup.config.scene, planned->plan.packed.balls, planned->scene.points);
  setup.config.tool.tool = planned->plan.tool;
  setup.config.cutting =
      simulation::CuttingForLevel(planned->plan.packed.level, planned->scene.cut, setup.config.cutting);
  setup.planned = std::move(planned);
  return {};
}

std::string PlannedText(const PlannedCell& planned) {
  const FidelityPlan& plan = planned.plan;
  std::string text =
      fmt::format("{}, for {:g} mm at {:g} Hz: {:.3f} mm", simulation::KindName(plan.packed.level.kind),
                  planned.request.error_m * 1e3, planned.request.rate_hz, plan.error_m * 1e3);
  if (planned.request.timed) text += fmt::format(", {:.0f} us a frame", plan.frame_us);
  text += " expected";
  for (const UnmetDemand& demand : plan.unmet)
    text += demand.what == "rate" ? fmt::format("; the rate was given up, {:.0f} Hz", demand.predicted)
                                  : fmt::format("; the error was given up, {:.3f} mm", demand.predicted);
  return text;
}

nlohmann::json PlannedJson(const PlannedCell& planned) {
  const FidelityPlan& plan = planned.plan;
  nlohmann::json json{{"error_mm", planned.request.error_m * 1e3},
                      {"rate_hz", planned.request.rate_hz},
                      {"packing", std::string(simulation::KindName(plan.packed.level.kind))},
                      {"zone_spacing_mm", plan.packed.level.fine.spacing_m * 1e3},
                      {"zone_r_max_mm", plan.packed.level.fine.radius_m * 1e3},
                      {"tool_spheres", plan.tool.balls.size()},
                      {"predicted_error_mm", plan.error_m * 1e3},
                      {"promised_error_mm", plan.promised_m * 1e3},
                      {"predicted_frame_us", nullptr},
                      {"given_up", nlohmann::json::array()}};
  if (planned.request.timed) json["predicted_frame_us"] = plan.frame_us;
  for (const UnmetDemand& demand : plan.unmet) json["given_up"].push_back(demand.what);
  json["unmet"] = json["given_up"];  // given_up is the older key, kept for programs that read it
  return json;
}

}  // namespace osteon::session
