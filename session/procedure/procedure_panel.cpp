#include "session/procedure/procedure_panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

#include "base/units.h"
#include "session/procedure/pass_detector.h"

namespace osteon::session {
namespace {

nlohmann::json Triple(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

// Rounds a figure of the message: a change smaller than the step does not cause a new message.
double Rounded(double value, double step) { return step * std::round(value / step); }

// Makes the message of the plan, with places in the world's frame. @param confirms a person confirms each
// change of tool
std::string PlanMessage(const procedure::SurgicalPlan& plan, const Pose& X_WG, bool confirms) {
  nlohmann::json reamers = nlohmann::json::array();
  for (const procedure::PlannedTool& tool : plan.tools)
    reamers.push_back({{"diameter_mm", 1e3 * tool.diameter_m},
                       {"centre_m", Triple(X_WG * plan.CentreOf(tool))},
                       {"around_m", tool.around_m}});
  nlohmann::json json{{"type", "plan"},
                      {"name", plan.name},
                      {"kind", plan.kind == procedure::PlanKind::kCup ? "cup" : "opening"},
                      {"axis", Triple((X_WG.linear() * plan.axis_G).normalized())},
                      {"cup_centre_m", Triple(X_WG * plan.centre_m)},
                      {"cup_radius_m", 0.5 * plan.cup_diameter_m},
                      {"reamers", reamers},
                      {"confirms", confirms},
                      {"corridor", nullptr}};
  if (const auto& g = plan.guidance; g.lateral.ease_m > 0.0)
    json["corridor"] = {{"cone_rad", g.cone.free_rad},
                        {"lateral_m", g.lateral.free_m},
                        {"widening_rad", g.lateral.widening_rad}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

PlanPlace PlaceAlongPlan(const procedure::SurgicalPlan& plan, const procedure::PlannedTool& tool,
                         const Pose& X_GT) {
  const Vector3 feed = X_GT.linear().col(2);
  // from the planned place of the head's centre to its present place
  const Vector3 offset_m = X_GT.translation() - 0.5 * tool.diameter_m * feed - plan.CentreOf(tool);
  PlanPlace place;
  place.to_go_m = offset_m.dot(plan.axis_G);
  place.aside_m = (offset_m - place.to_go_m * plan.axis_G).norm();
  place.tilt_rad = std::atan2(plan.axis_G.cross(feed).norm(), -plan.axis_G.dot(feed));
  const procedure::GuidanceGains& g = plan.guidance;
  if (!(g.lateral.ease_m > 0.0)) return place;
  place.beyond_tilt = place.tilt_rad > g.cone.free_rad;
  place.beyond_aside =
      place.aside_m > tool.around_m + g.lateral.free_m + place.to_go_m * std::tan(g.lateral.widening_rad);
  place.beyond_depth = place.to_go_m < g.depth.soft_m;
  return place;
}

ProcedurePanel::ProcedurePanel(procedure::SurgicalPlan plan, const Pose& X_WG, bool confirms)
    : plan_(std::move(plan)),
      X_GW_(X_WG.inverse()),
      has_guidance_(plan_.guidance.lateral.ease_m > 0.0),
      plan_json_(PlanMessage(plan_, X_WG, confirms)) {}

void ProcedurePanel::Step(int tool, const simulation::ContactModel& model, rt::Nanoseconds stamp) {
  const procedure::PlannedTool& reamer = plan_.tools[static_cast<std::size_t>(tool)];
  const Pose X_GP = X_GW_ * Pose(model.X_WP);
  const PlanPlace place = PlaceAlongPlan(plan_, reamer, X_GP);
  const std::lock_guard lock(mutex_);
  if (tool != tool_) {
    tool_ = tool;
    axis_ = {};
    removed_by_tool_m3_ = 0.0;
  }
  const double new_m3 = known_ ? std::max(0.0, model.removed_volume_m3 - removed_m3_) : 0.0;
  removed_m3_ = model.removed_volume_m3;
  known_ = true;
  place_ = place;
  const double dt_s = std::clamp(rt::ToSeconds(stamp - std::exchange(stamp_, stamp)), 0.0, kMaxFrameGap_s);
  if (!(new_m3 > 0.0)) return;
  removed_by_tool_m3_ += new_m3;
  axis_.Add(X_GP.linear().col(2), new_m3);
  if (place.beyond_tilt || place.beyond_aside || place.beyond_depth) outside_s_ += dt_s;
}

std::string ProcedurePanel::Json(const SessionFile& session, double gain) const {
  nlohmann::json json{{"type", "procedure"}};
  {
    const std::lock_guard lock(mutex_);
    json["known"] = known_;
    json["tool"] = std::max(0, tool_);
    json["to_go_mm"] = Rounded(1e3 * place_.to_go_m, 0.1);
    json["aside_mm"] = Rounded(1e3 * place_.aside_m, 0.1);
    json["tilt_deg"] = Rounded(place_.tilt_rad / kDegree, 0.1);
    json["beyond"] = {
        {"tilt", place_.beyond_tilt}, {"aside", place_.beyond_aside}, {"depth", place_.beyond_depth}};
    const auto axis_G = axis_.value();
    json["axis_error_deg"] =
        axis_G
            ? nlohmann::json(Rounded(
                  std::atan2(plan_.axis_G.cross(*axis_G).norm(), plan_.axis_G.dot(*axis_G)) / kDegree, 0.1))
            : nlohmann::json(nullptr);
    json["removed_mm3"] = Rounded(1e9 * removed_by_tool_m3_, 1.0);
    json["outside_s"] = Rounded(outside_s_, 0.1);
  }
  json["passes"] = session.PassesLeft();
  json["undone"] = session.passes.size() - static_cast<std::size_t>(session.PassesLeft());
  json["guidance"] = has_guidance_ ? nlohmann::json(gain) : nlohmann::json(nullptr);
  json["cup"] = session.cup_X_GT.has_value();
  return json.dump();
}

}  // namespace osteon::session
