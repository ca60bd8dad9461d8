#include "studies/capability/capability_result.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace osteon::studies {
namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

// "A3" for index 2; "no joint" below 0.
std::string Joint(int joint) { return joint < 0 ? "no joint" : fmt::format("A{}", joint + 1); }

// Returns zero for an infinite value: no pose could be judged, and JSON has no infinity.
double Shown(double value) { return std::isfinite(value) ? value : 0.0; }

// The smallest forces over the task with the joints that limit them, as one line.
std::string Forces(const CapabilityMap::Task& task) {
  if (task.unreachable == task.poses) return "no pose of the task has a posture within the joint limits";
  std::string text =
      fmt::format("axial {:.0f} N ({}), lateral {:.0f} N ({}); both needs at once x {:.2f} ({})",
                  task.force.axial_N, Joint(task.force.axial_joint), task.force.lateral_N,
                  Joint(task.force.lateral_joint), task.force.factor, Joint(task.force.factor_joint));
  if (task.unreachable > 0)
    text += fmt::format("; {} of {} poses have no posture", task.unreachable, task.poses);
  return text;
}

nlohmann::json ToJson(const ToolForce& force, const CapabilityNeed& need) {
  return {{"axial_min_N", Shown(force.axial_N)},
          {"axial_joint", Joint(force.axial_joint)},
          {"axial_gravity_counted_min_N", Shown(force.axial_exact_N)},
          {"lateral_min_N", Shown(force.lateral_N)},
          {"lateral_joint", Joint(force.lateral_joint)},
          {"lateral_while_pressed_min_N", Shown(force.pressed_lateral_N)},
          {"need_factor_min", Shown(force.factor)},
          {"need_joint", Joint(force.factor_joint)},
          {"guaranteed_axial_N", Shown(force.factor) * need.axial_N},
          {"guaranteed_lateral_N", Shown(force.factor) * need.lateral_N},
          {"joint_room_min_deg", Shown(force.joint_room_rad) * kDegreesPerRadian},
          {"joint_room_joint", Joint(force.room_joint)}};
}

nlohmann::json ToJson(const CapabilityMap::Task& task, const CapabilityNeed& need) {
  nlohmann::json json = ToJson(task.force, need);
  json["poses"] = task.poses;
  json["unreachable"] = task.unreachable;
  return json;
}

// A vector's coordinates in another unit, rounded to six places.
nlohmann::json ToJson(const Vector3& v, double scale) {
  return {std::round(v.x() * scale * 1e6) * 1e-6, std::round(v.y() * scale * 1e6) * 1e-6,
          std::round(v.z() * scale * 1e6) * 1e-6};
}

// Rounds to a whole number, without a negative zero.
double RoundToWhole(double value) { return std::round(value) + 0.0; }

}  // namespace

Vector3 RollPitchYaw(const Matrix3& R) {
  const double pitch = std::asin(std::clamp(-R(2, 0), -1.0, 1.0));
  // The axis points straight up or down: roll and yaw turn about the same axis, so the whole turn is stated
  // as yaw.
  if (std::abs(R(2, 0)) > 1.0 - 1e-12) return {0.0, pitch, std::atan2(-R(0, 1), R(1, 1))};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

namespace {

// Says why the arm can't hold the whole need over the task; empty if it can.
std::string DescribeUnmetNeed(const CapabilityMap::Task& task, const CapabilityNeed& need) {
  if (task.unreachable == task.poses) return "no pose of the task has a posture within the joint limits";
  if (task.unreachable > 0)
    return fmt::format("{} of {} poses of the task have no posture within the joint limits", task.unreachable,
                       task.poses);
  if (task.force.factor >= 1.0) return {};
  return fmt::format(
      "{:.0f} N along the tool with {:.0f} N across it are needed at once, {:.0f} N with {:.0f} N are "
      "the most ({} limits)",
      need.axial_N, need.lateral_N, task.force.factor * need.axial_N, task.force.factor * need.lateral_N,
      Joint(task.force.factor_joint));
}

}  // namespace

session::Verdict Judge(const CapabilityResult& r) {
  session::Verdict verdict;
  const std::string best = DescribeUnmetNeed(r.best_angle, r.need),
                    own = DescribeUnmetNeed(r.own_angle, r.need);
  if (!best.empty())
    verdict.Add(session::VerdictLevel::kBad, "from the cell's base, at the best arm angles: " + best);
  else if (!own.empty())
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("at the cell's arm angle of {:.0f} deg: {}; other arm angles do",
                            r.own_arm_angle_rad * kDegreesPerRadian, own));
  if (r.outside > 0)
    verdict.Add(session::VerdictLevel::kWarning,
                fmt::format("{} of {} poses of the task lie outside the cell's workspace and were not judged",
                            r.outside, r.outside + r.best_angle.poses));
  if (r.searched && !r.base)
    verdict.Add(session::VerdictLevel::kWarning,
                "the task can be done from no base in the ranges that were searched");
  else if (r.searched && r.base_force.factor < 1.0)
    verdict.Add(
        session::VerdictLevel::kWarning,
        fmt::format(
            "the best base of the ranges that were searched holds {:.0f} N along the tool with {:.0f} N "
            "across it, {:.0f} % of what is needed",
            r.base_force.factor * r.need.axial_N, r.base_force.factor * r.need.lateral_N,
            100.0 * r.base_force.factor));
  if (r.rendering) JudgeRendering(*r.rendering, verdict);
  return verdict;
}

std::vector<report::SummaryRow> Rows(const CapabilityResult& r) {
  std::vector<report::SummaryRow> rows{
      {"Cell", fmt::format("{}, {}", r.cell, r.tool)},
      {"Task",
       fmt::format("centre of the tool's head within {:.0f} mm of the site's axis, {:.0f} to {:.0f} mm along "
                   "it; tool tilted by up to {:.0f} deg; {} poses{}",
                   r.task.radius_m * 1e3, r.task.bottom_m * 1e3, r.task.top_m * 1e3,
                   r.task.tilt_rad * kDegreesPerRadian, r.best_angle.poses,
                   r.outside > 0 ? fmt::format(", and {} outside the workspace", r.outside) : "")},
      {"Needed",
       fmt::format(
           "{:.0f} N along the tool and {:.0f} N across it ({}){}", r.need.axial_N, r.need.lateral_N,
           r.need.lateral_from,
           r.need.torque_Nm > 0.0 ? fmt::format(", {:.1f} N·m about any axis", r.need.torque_Nm) : "")},
      {"This base, best arm angles", Forces(r.best_angle)},
      {fmt::format("This base, arm angle {:.0f} deg", r.own_arm_angle_rad * kDegreesPerRadian),
       Forces(r.own_angle)}};
  if (r.rendering)
    for (report::SummaryRow& row : RenderingRows(*r.rendering, r.own_angle.force.axial_N))
      rows.push_back(std::move(row));
  if (!r.searched) return rows;
  if (!r.base) {
    rows.push_back({"Best base", "none: the task can be done from nowhere in the ranges"});
    return rows;
  }
  const Vector3 p_mm = 1e3 * r.base->X_WB.translation(),
                rpy_deg = kDegreesPerRadian * RollPitchYaw(r.base->X_WB.linear());
  rows.push_back({"Best base",
                  fmt::format("{:.0f}, {:.0f}, {:.0f} mm, rpy {:.0f}, {:.0f}, {:.0f} deg, arm angle {:.0f} "
                              "deg",
                              RoundToWhole(p_mm.x()), RoundToWhole(p_mm.y()), RoundToWhole(p_mm.z()),
                              RoundToWhole(rpy_deg.x()), RoundToWhole(rpy_deg.y()), RoundToWhole(rpy_deg.z()),
                              RoundToWhole(r.base->arm_angle_rad * kDegreesPerRadian))});
  const ToolForce& f = r.base_force;
  rows.push_back(
      {"Guaranteed there",
       fmt::format("axial {:.0f} N ({}), lateral {:.0f} N ({}); both needs at once x "
                   "{:.2f}: {:.0f} N and {:.0f} N ({})",
                   f.axial_N, Joint(f.axial_joint), f.lateral_N, Joint(f.lateral_joint), f.factor,
                   f.factor * r.need.axial_N, f.factor * r.need.lateral_N, Joint(f.factor_joint))});
  rows.push_back({"Nearest joint limit there",
                  fmt::format("{:.0f} deg ({})", f.joint_room_rad * kDegreesPerRadian, Joint(f.room_joint))});
  rows.push_back(
      {"Enough there",
       f.factor >= 1.0
           ? fmt::format("yes: {:.0f} N axial and {:.0f} N lateral at once are available throughout",
                         r.need.axial_N, r.need.lateral_N)
           : fmt::format("no: {:.0f} N axial with {:.0f} N lateral are not to be had: {:.0f} N with "
                         "{:.0f} N is the most, {} limits",
                         r.need.axial_N, r.need.lateral_N, f.factor * r.need.axial_N,
                         f.factor * r.need.lateral_N, Joint(f.factor_joint))});
  return rows;
}

std::string ToJson(const CapabilityResult& r, const std::string& command_line) {
  nlohmann::json json{{"schema", "osteon.capability/1"},
                      {"subcommand", "capability"},
                      {"command_line", command_line},
                      {"cell", r.cell},
                      {"tool", r.tool},
                      {"need",
                       {{"axial_N", r.need.axial_N},
                        {"lateral_N", r.need.lateral_N},
                        {"lateral_from", r.need.lateral_from},
                        {"torque_Nm", r.need.torque_Nm}}},
                      {"task",
                       {{"radius_mm", r.task.radius_m * 1e3},
                        {"bottom_mm", r.task.bottom_m * 1e3},
                        {"top_mm", r.task.top_m * 1e3},
                        {"tilt_deg", r.task.tilt_rad * kDegreesPerRadian},
                        {"head_radius_mm", r.task.head_radius_m * 1e3},
                        {"site_mm", ToJson(r.task.X_WC.translation(), 1e3)},
                        {"poses", r.best_angle.poses},
                        {"outside_workspace", r.outside}}},
                      {"axial_min_N", Shown(r.best_angle.force.axial_N)},
                      {"lateral_min_N", Shown(r.best_angle.force.lateral_N)},
                      {"best_arm_angles", ToJson(r.best_angle, r.need)},
                      {"own_arm_angle", ToJson(r.own_angle, r.need)},
                      {"best_base", nullptr}};
  json["own_arm_angle"]["arm_angle_deg"] = r.own_arm_angle_rad * kDegreesPerRadian;
  json["searched"] = r.searched;
  json["rendering"] =
      r.rendering ? RenderingJson(*r.rendering, Shown(r.own_angle.force.axial_N)) : nlohmann::json();
  if (!r.searched) return session::ResultText(Judge(r), json);
  const auto range = [](const AxisRange& a) { return nlohmann::json{a.from * 1e3, a.to * 1e3}; };
  json["search"] = {{"x_mm", range(r.search.x_m)},
                    {"y_mm", range(r.search.y_m)},
                    {"z_mm", range(r.search.z_m)},
                    {"clearance_mm", r.search.clearance_m * 1e3},
                    {"joint_margin_deg", r.search.joint_margin_rad * kDegreesPerRadian},
                    {"least_bend_deg", r.search.min_bend_rad * kDegreesPerRadian}};
  if (!r.base) return session::ResultText(Judge(r), json);
  nlohmann::json base = ToJson(r.base_force, r.need);
  base["position_mm"] = ToJson(r.base->X_WB.translation(), 1e3);
  base["rpy_deg"] = ToJson(RollPitchYaw(r.base->X_WB.linear()), kDegreesPerRadian);
  base["arm_angle_deg"] = RoundToWhole(r.base->arm_angle_rad * kDegreesPerRadian);
  base["sufficient"] = r.base_force.factor >= 1.0;
  json["best_base"] = base;
  return session::ResultText(Judge(r), json);
}

std::string MapCsv(const CapabilityResult& r) {
  std::string csv = "plane,x_mm,y_mm,z_mm,axial_N,lateral_N,own_axial_N,own_lateral_N\n";
  const auto number = [](double value) { return std::isfinite(value) ? fmt::format("{:.2f}", value) : ""; };
  for (const MapPanel& panel : r.maps)
    for (std::size_t i = 0; i < panel.axial_N.size(); ++i) {
      const Vector3 p_mm = 1e3 * panel.Node(i);
      csv += fmt::format("{},{:.1f},{:.1f},{:.1f},{},{},{},{}\n",
                         panel.plane == MapPlane::kVertical ? "vertical" : "horizontal", p_mm.x(), p_mm.y(),
                         p_mm.z(), number(panel.axial_N[i]), number(panel.lateral_N[i]),
                         number(panel.own_axial_N[i]), number(panel.own_lateral_N[i]));
    }
  return csv;
}

std::string BaseYaml(const CapabilityResult& r, const std::string& command_line) {
  const Vector3 p_mm = 1e3 * r.base->X_WB.translation(),
                rpy_deg = kDegreesPerRadian * RollPitchYaw(r.base->X_WB.linear());
  return fmt::format(
      "# {}\n# Guaranteed over the task: {:.0f} N along the tool with {:.0f} N across it at once; alone "
      "{:.0f} N and {:.0f} N.\n# In place of the cell's own lines:\nbase_in_world:\n  position_mm: [{:.0f}, "
      "{:.0f}, {:.0f}]\n"
      "  rpy_deg: [{:.0f}, {:.0f}, {:.0f}]\nstart:\n  arm_angle_deg: {:.0f}\n",
      command_line, r.base_force.factor * r.need.axial_N, r.base_force.factor * r.need.lateral_N,
      r.base_force.axial_N, r.base_force.lateral_N, RoundToWhole(p_mm.x()), RoundToWhole(p_mm.y()),
      RoundToWhole(p_mm.z()), RoundToWhole(rpy_deg.x()), RoundToWhole(rpy_deg.y()), RoundToWhole(rpy_deg.z()),
      RoundToWhole(r.base->arm_angle_rad * kDegreesPerRadian));
}

}  // namespace osteon::studies
