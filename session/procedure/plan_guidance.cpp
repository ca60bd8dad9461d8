#include "session/procedure/plan_guidance.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::session {
namespace {

using procedure::GuidanceCeilings;

// A tool is a planned reamer if their diameters differ by less than this.
constexpr double kSameDiameter_m = 1e-6;

// The parser of a plan accepts the same gains as the servo loop.
static_assert(GuidanceCeilings::kConeStiffness_Nm_per_rad == control::kMaxConeStiffness_Nm_per_rad);
static_assert(GuidanceCeilings::kConeCap_Nm == control::kMaxConeTorque_Nm);
static_assert(GuidanceCeilings::kLateralStiffness_N_per_m == control::kMaxLateralStiffness_N_per_m);
static_assert(GuidanceCeilings::kLateralCap_N == control::kMaxLateralForce_N);
static_assert(GuidanceCeilings::kDepthStiffness_N_per_m == control::kMaxDepthStiffness_N_per_m);
static_assert(GuidanceCeilings::kDepthCap_N == control::kMaxDepthForce_N);

// Calls visit(name, value) for every field but axis_W and centre_W.
template <class Params, class Visit>
void VisitGuidance(Params& g, Visit&& visit) {
  visit("gain", g.gain);
  visit("head_m", g.head_m);
  visit("stops_spindle", g.stops_spindle);
  visit("cone_free_rad", g.cone_free_rad);
  visit("cone_stop_rad", g.cone_stop_rad);
  visit("lateral_free_m", g.lateral_free_m);
  visit("lateral_stop_m", g.lateral_stop_m);
  visit("widening_rad", g.widening_rad);
  visit("depth_soft_m", g.depth_soft_m);
  visit("cone_stiffness", g.cone.stiffness);
  visit("cone_ease", g.cone.ease);
  visit("cone_cap", g.cone.cap);
  visit("lateral_stiffness", g.lateral.stiffness);
  visit("lateral_ease", g.lateral.ease);
  visit("lateral_cap", g.lateral.cap);
  visit("depth_stiffness", g.depth.stiffness);
  visit("depth_ease", g.depth.ease);
  visit("depth_cap", g.depth.cap);
  visit("return_m_per_s", g.return_m_per_s);
  visit("return_rad_per_s", g.return_rad_per_s);
  visit("damping_Ns_per_m", g.damping_Ns_per_m);
  visit("damping_Nms_per_rad", g.damping_Nms_per_rad);
}

}  // namespace

std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                  const procedure::PlannedTool& tool, const Pose& X_WG) {
  const procedure::GuidanceGains& gains = plan.guidance;
  if (!(gains.lateral.ease_m > 0.0)) return std::nullopt;  // the plan's file has no guidance
  control::GuidanceParams guidance{
      .axis_W = (X_WG.linear() * plan.axis_G).normalized(),
      .centre_W = X_WG * plan.CentreOf(tool),
      .head_m = 0.5 * tool.diameter_m,
      .gain = gains.gain,
      .stops_spindle = gains.spindle == procedure::GuidanceGains::OutsideSpindle::kStop,
      .cone_free_rad = gains.cone.free_rad,
      .cone_stop_rad = gains.cone.stop_rad,
      .lateral_free_m = tool.around_m + gains.lateral.free_m,
      .lateral_stop_m = tool.around_m + gains.lateral.stop_m,
      .widening_rad = gains.lateral.widening_rad,
      .depth_soft_m = gains.depth.soft_m,
      .cone = {.stiffness = gains.cone.stiffness_Nm_per_rad,
               .ease = gains.cone.ease_rad,
               .cap = gains.cone.cap_Nm},
      .lateral = {.stiffness = gains.lateral.stiffness_N_per_m,
                  .ease = gains.lateral.ease_m,
                  .cap = gains.lateral.cap_N},
      .depth = {.stiffness = gains.depth.stiffness_N_per_m,
                .ease = gains.depth.ease_m,
                .cap = gains.depth.cap_N},
      .return_m_per_s = gains.return_m_per_s,
      .return_rad_per_s = gains.return_rad_per_s};
  control::Validate(guidance);
  return guidance;
}

std::optional<control::GuidanceParams> GuidanceOf(const procedure::SurgicalPlan& plan,
                                                  const simulation::Tool& tool, const Pose& X_WG) {
  const simulation::ToolBall* head = simulation::CuttingHead(tool);
  const double diameter_m = head ? 2.0 * head->radius_m : 0.0;
  std::string accepted;
  for (const procedure::PlannedTool& reamer : plan.tools) {
    if (std::abs(reamer.diameter_m - diameter_m) < kSameDiameter_m) return GuidanceOf(plan, reamer, X_WG);
    accepted += fmt::format("{}{:g}", accepted.empty() ? "" : ", ", 1e3 * reamer.diameter_m);
  }
  throw std::invalid_argument(fmt::format("plan {}: found a tool of {:g} mm, accepted its reamers of {} mm",
                                          plan.name, 1e3 * diameter_m, accepted));
}

nlohmann::json ToJson(const control::GuidanceParams& guidance) {
  const Vector3 &a = guidance.axis_W, &c = guidance.centre_W;
  nlohmann::json json{{"axis_W", {a.x(), a.y(), a.z()}}, {"centre_W_m", {c.x(), c.y(), c.z()}}};
  VisitGuidance(guidance, [&](const char* name, const auto& value) { json[name] = value; });
  return json;
}

control::GuidanceParams GuidanceFromJson(const nlohmann::json& json) {
  control::GuidanceParams guidance;
  const auto vector = [&](const char* name) {
    const auto& v = json.at(name);
    return Vector3(v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>());
  };
  guidance.axis_W = vector("axis_W");
  guidance.centre_W = vector("centre_W_m");
  VisitGuidance(guidance, [&](const char* name, auto& value) { json.at(name).get_to(value); });
  control::Validate(guidance);
  return guidance;
}

}  // namespace osteon::session
