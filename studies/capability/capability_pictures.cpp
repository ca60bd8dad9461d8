#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/percentile.h"
#include "report/heat_map.h"
#include "report/svg_text.h"
#include "studies/capability/capability_result.h"

// The pictures of `osteon capability`: maps of the force over the workspace, and over places of the base.

namespace osteon::studies {
namespace {

// Colour of the task's outline and of the site.
constexpr const char* kTaskColor = "#d55e00";

// Chooses the colour scale: it ends at a round number above the need and above 95 % of the values.
report::HeatScale ScaleOf(const std::vector<const std::vector<double>*>& fields, double need_N,
                          const std::string& label) {
  std::vector<double> values;
  for (const std::vector<double>* field : fields)
    for (const double value : *field)
      if (std::isfinite(value)) values.push_back(value);
  const double percentile_95_N = values.empty() ? 0.0 : base::Percentile(values, 0.95);
  // The scale gets 8 to 15 bands of a round width, two bands from one tick to the next.
  const double top = std::clamp(1.1 * std::max(percentile_95_N, need_N), 50.0, 1000.0);
  double tick = 10.0;
  for (const double width : {20.0, 50.0, 100.0, 200.0})
    if (tick * 7.5 < top) tick = width;
  return {
      .label = label, .min = 0.0, .max = tick * std::ceil(top / tick), .step = 0.5 * tick, .tick_step = tick};
}

// The forces at which contour lines are drawn: each tick of the scale, and the need.
std::vector<double> Levels(const report::HeatScale& scale, double need_N) {
  std::vector<double> levels;
  for (double value = scale.min + scale.tick_step; value < scale.max; value += scale.tick_step)
    levels.push_back(value);
  if (std::none_of(levels.begin(), levels.end(),
                   [&](double level) { return std::abs(level - need_N) < 1.0; }))
    levels.push_back(need_N);
  return levels;
}

// Outlines the intersection of the task's cylinder with a panel's plane, in mm of the panel.
report::Polyline TaskOutline(const TaskVolume& task, const MapPanel& panel) {
  constexpr int kSides = 72;
  report::Polyline outline{.points = {}, .closed = true};
  const auto add = [&](const Vector3& p_C) {
    const Vector3 p = task.X_WC * p_C - panel.origin_W;
    outline.points.push_back({1e3 * p.dot(panel.u_W), 1e3 * p.dot(panel.v_W)});
  };
  const Matrix3 R_CW = task.X_WC.linear().transpose();
  const Vector3 normal_C = R_CW * panel.u_W.cross(panel.v_W);
  if (std::abs(normal_C.z()) > 0.7) {
    // The panel's plane is across the cylinder's axis: draw the rim at the plane's height.
    for (int k = 0; k < kSides; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / kSides;
      const Vector3 rim(task.radius_m * std::cos(angle), task.radius_m * std::sin(angle), 0.0);
      add({rim.x(), rim.y(), -(normal_C.x() * rim.x() + normal_C.y() * rim.y()) / normal_C.z()});
    }
    return outline;
  }
  // The panel's plane is along the cylinder's axis: draw the two sides.
  const Vector3 side = Vector3::UnitZ().cross(normal_C).normalized() * task.radius_m;
  for (const auto& [sign, height] :
       {std::pair{-1.0, task.bottom_m}, {1.0, task.bottom_m}, {1.0, task.top_m}, {-1.0, task.top_m}})
    add(sign * side + Vector3(0.0, 0.0, height));
  return outline;
}

// Outlines the region in which the workspace permits the head's centre of an upright tool. The workspace
// bounds the apex, so its outline is shifted by the vector from the apex to the head's centre.
report::Polyline WorkspaceOutline(const TaskVolume& task, const MapPanel& panel) {
  constexpr int kSides = 180;
  const safety::WorkspaceParams& space = task.workspace;
  const Vector3 p_apex_head = task.head_radius_m * task.X_WC.linear().col(2);
  const Vector3 center = space.sphere_center_W_m + p_apex_head - panel.origin_W;
  const Vector3 normal = panel.u_W.cross(panel.v_W);
  const double off = center.dot(normal);
  report::Polyline outline{.points = {}, .closed = true};
  if (std::abs(off) >= space.sphere_radius_m) return outline;
  const double radius = std::sqrt(space.sphere_radius_m * space.sphere_radius_m - off * off);
  const report::Vector2 middle(center.dot(panel.u_W), center.dot(panel.v_W));
  // the workspace's plane within the panel, as n·p >= d
  const report::Vector2 n(space.plane_normal_W.dot(panel.u_W), space.plane_normal_W.dot(panel.v_W));
  const double d = space.plane_offset_m - space.plane_normal_W.dot(panel.origin_W - p_apex_head);
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kSides;
    report::Vector2 p = middle + radius * report::Vector2(std::cos(angle), std::sin(angle));
    // The point is beyond the workspace's plane: project it back along the plane's normal.
    if (n.norm() > 1e-9 && n.dot(p) < d) p += (d - n.dot(p)) / n.squaredNorm() * n;
    outline.points.push_back(1e3 * p);
  }
  return outline;
}

// The heat map of one force on one plane.
report::HeatMap PanelOf(const CapabilityResult& r, const MapPanel& panel, const std::vector<double>& values,
                        const std::string& what, const report::HeatScale& scale, double need_N) {
  const bool vertical = panel.plane == MapPlane::kVertical;
  const bool away = (r.task.X_WC.translation() - r.X_WB.translation()).dot(panel.u_W) >= 0.0;
  return {
      .title = fmt::format("{}, {} section", what, vertical ? "vertical" : "horizontal"),
      .x_label = !vertical ? "x from the site [mm]"
                 : away    ? "away from the base [mm]"
                           : "towards the base [mm]",
      .y_label = vertical ? "up from the site [mm]" : "y from the site [mm]",
      .x = {1e3 * panel.u_from_m, 1e3 * (panel.u_from_m + panel.step_m * (panel.nu - 1))},
      .y = {1e3 * panel.v_from_m, 1e3 * (panel.v_from_m + panel.step_m * (panel.nv - 1))},
      .nx = panel.nu,
      .ny = panel.nv,
      .values = values,
      .contours = Levels(scale, need_N),
      .lines = {{.line = WorkspaceOutline(r.task, panel), .color = "#ffffff", .width_px = 3.4},
                {.line = WorkspaceOutline(r.task, panel), .dashed = true},
                {.line = TaskOutline(r.task, panel), .color = kTaskColor, .width_px = 2.0}},
      .marks = {{.x = 0.0, .y = 0.0, .marker = report::Marker::kCross, .color = kTaskColor, .label = ""}}};
}

}  // namespace

std::string MapSvg(const CapabilityResult& r, bool own_arm_angle) {
  std::vector<const std::vector<double>*> axial, lateral;
  for (const MapPanel& panel : r.maps) {
    axial.push_back(own_arm_angle ? &panel.own_axial_N : &panel.axial_N);
    lateral.push_back(own_arm_angle ? &panel.own_lateral_N : &panel.lateral_N);
  }
  const std::vector<report::HeatScale> scales{ScaleOf(axial, r.need.axial_N, "axial force [N]"),
                                              ScaleOf(lateral, r.need.lateral_N, "lateral force [N]")};
  std::vector<report::HeatMap> panels;
  for (std::size_t i = 0; i < r.maps.size(); ++i)
    panels.push_back(PanelOf(r, r.maps[i], *axial[i], "Axial", scales[0], r.need.axial_N));
  for (std::size_t i = 0; i < r.maps.size(); ++i)
    panels.push_back(PanelOf(r, r.maps[i], *lateral[i], "Lateral", scales[1], r.need.lateral_N));
  return report::HeatMapSvg(
      panels, static_cast<int>(r.maps.size()), scales,
      own_arm_angle
          ? fmt::format("Force held at arm angle {:.0f} deg", r.own_arm_angle_rad * 180.0 / std::numbers::pi)
          : "Force held at the best arm angle",
      {{.text = "task: the head's centre", .color = kTaskColor},
       {.text = "workspace", .color = report::kTextColor, .mark = report::LegendEntry::Mark::kDash},
       {.text = "no posture", .color = "#e4e6e9", .mark = report::LegendEntry::Mark::kFill}});
}

std::string BaseSvg(const CapabilityResult& r) {
  if (r.base_panels.empty()) return {};
  std::vector<const std::vector<double>*> fields;
  for (const BasePanel& panel : r.base_panels) fields.push_back(&panel.force_N);
  const report::HeatScale scale = ScaleOf(fields, r.need.axial_N, "guaranteed axial force [N]");
  std::vector<report::HeatMap> panels;
  for (const BasePanel& p : r.base_panels)
    panels.push_back({.title = p.title,
                      .x_label = p.x_label,
                      .y_label = p.y_label,
                      .x = {1e3 * p.x_from_m, 1e3 * (p.x_from_m + p.step_m * (p.nx - 1))},
                      .y = {1e3 * p.y_from_m, 1e3 * (p.y_from_m + p.step_m * (p.ny - 1))},
                      .nx = p.nx,
                      .ny = p.ny,
                      .values = p.force_N,
                      .contours = Levels(scale, r.need.axial_N),
                      .marks = {{.x = 1e3 * p.site[0],
                                 .y = 1e3 * p.site[1],
                                 .marker = report::Marker::kCross,
                                 .color = kTaskColor,
                                 .label = "site"},
                                {.x = 1e3 * p.own[0],
                                 .y = 1e3 * p.own[1],
                                 .marker = report::Marker::kSquare,
                                 .color = "#1b1f24",
                                 .label = "base now"},
                                {.x = 1e3 * p.best[0],
                                 .y = 1e3 * p.best[1],
                                 .marker = report::Marker::kDiamond,
                                 .color = "#d55e00",
                                 .label = "best"}}});
  return report::HeatMapSvg(panels, 2, {scale}, "Where the base may stand",
                            {{.text = "the task can't be done from there",
                              .color = "#e4e6e9",
                              .mark = report::LegendEntry::Mark::kFill}});
}

}  // namespace osteon::studies
