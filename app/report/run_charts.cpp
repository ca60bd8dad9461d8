#include "app/report/run_charts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/report/svg_plot.h"
#include "control/ports.h"
#include "control/tick_state.h"

namespace osteon::app {
namespace {

using control::Phase;
using control::TickRecord;
using simulation::FrameRecord;

/// Names the parts of the run in which the loop did not render.
std::vector<NamedSpan> PhaseSpans(std::span<const TickRecord> ticks, const TimeAxis& time) {
  std::vector<NamedSpan> spans;
  for (std::size_t i = 0; i < ticks.size();) {
    std::size_t end = i;
    while (end < ticks.size() && ticks[end].phase == ticks[i].phase &&
           control::IsPaused(ticks[end]) == control::IsPaused(ticks[i]))
      ++end;
    const double from_s = time.At(ticks[i].stamp);
    const double to_s = time.At(ticks[std::min(end, ticks.size() - 1)].stamp);
    switch (ticks[i].phase) {
      case Phase::kWaiting:
        spans.push_back(
            {from_s, to_s, control::IsPaused(ticks[i]) ? "paused" : "waiting for the arm", "#e6eef5"});
        break;
      case Phase::kHaptic:
        break;
      case Phase::kAligning:
        spans.push_back({from_s, to_s, "moving to the start", "#e3f0e3"});
        break;
      case Phase::kStopping:
        spans.push_back({from_s, to_s, "stopping", "#f6dcc8"});
        break;
      case Phase::kStopped:
        spans.push_back({from_s, to_s, "stopped", "#e4e4e4"});
        break;
    }
    i = end;
  }
  return spans;
}

std::string LatencyHistogram(std::string title, std::vector<double> values) {
  if (std::none_of(values.begin(), values.end(), [](double value) { return value > 0.0; })) return {};
  return Svg(Histogram{.title = std::move(title),
                       .x_label = "time [µs]",
                       .values = std::move(values),
                       .log_x = true,
                       .log_y = true,
                       .unit = "µs"});
}

/// Without a message of the arm nothing is computed, and nothing sent: its zeros are no force.
bool Computed(const TickRecord& tick) { return tick.phase == Phase::kWaiting || control::HasMessage(tick); }

std::vector<LimitLine> Mark(const TimeAxis& time) {
  return time.mark.empty() ? std::vector<LimitLine>{} : std::vector<LimitLine>{{0.0, time.mark}};
}

}  // namespace

std::string ForceChart(std::span<const TickRecord> ticks, double force_limit_N, const TimeAxis& time) {
  const std::vector<double> t_s = time.Of(ticks);
  Series coupling{.name = "rendered coupling force", .x = t_s};
  Series axial{.name = "its part along the tool (resisting)", .x = t_s, .width_px = 1.1};
  Series hand{.name = "hand's force (sensor)", .x = t_s, .width_px = 1.1};
  for (const TickRecord& tick : ticks) {
    if (!Computed(tick)) {
      for (Series* series : {&coupling, &axial, &hand})
        series->y.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const Wrench F_T_W = tick.F_coupling_T_W;
    const Vector3 feed_W = Pose(tick.X_WT_cmd).linear().col(2);
    coupling.y.push_back(F_T_W.f.norm());
    axial.y.push_back(-F_T_W.f.dot(feed_W));
    hand.y.push_back(Wrench(tick.F_operator_T_W).f.norm());
  }
  LineChart chart{.x_label = time.label,
                  .y_label = "force [N]",
                  .series = {std::move(hand), std::move(coupling), std::move(axial)},
                  .limits = {{force_limit_N, fmt::format("limit {:g} N", force_limit_N)}},
                  .x_limits = Mark(time),
                  .spans = PhaseSpans(ticks, time),
                  .plot_height_px = 270.0};
  chart.series[0].color = "#009e73";
  chart.series[1].color = "#0072b2";
  chart.series[2].color = "#d55e00";
  if (std::none_of(ticks.begin(), ticks.end(),
                   [](const TickRecord& tick) { return tick.wrench_scale < 1.0; }))
    return Svg(chart);

  // what a limit kept from the hand
  Series rendered{.name = "rendered", .x = t_s, .y = {}, .color = "#0072b2"};
  Series held{
      .name = "that the arm's torques can hold", .x = t_s, .y = {}, .color = "#cc79a7", .width_px = 1.1};
  for (const TickRecord& tick : ticks) {
    rendered.y.push_back(100.0 * tick.wrench_scale);
    held.y.push_back(100.0 * tick.arm_share);
  }
  LineChart shares{.title = "Share of the coupling's wrench",
                   .x_label = time.label,
                   .y_label = "share [%]",
                   .y = Range{0.0, 105.0},
                   .series = {std::move(held), std::move(rendered)},
                   .plot_height_px = 110.0};
  chart.x_label.clear();
  return Svg(std::vector<LineChart>{std::move(chart), std::move(shares)});
}

std::string ProgressChart(std::span<const TickRecord> ticks, std::span<const FrameRecord> frames) {
  TimeAxis time = FromFirst(ticks);
  if (ticks.empty() && !frames.empty()) time.zero = frames.front().stamp;
  Series depth{.name = "", .color = "#0072b2", .width_px = 1.8};
  Series volume{.name = "", .color = "#d55e00", .width_px = 1.8};
  bool touched = false;
  for (const FrameRecord& frame : frames) {
    const double t_s = time.At(frame.stamp);
    // the way there says nothing: from first touch on
    touched = touched || Wrench(frame.model.F_T_W).f.norm() > 0.0 || frame.model.removed_volume_m3 > 0.0;
    depth.x.push_back(t_s);
    depth.y.push_back(touched ? 1e3 * frame.cup_depth_m : std::numeric_limits<double>::quiet_NaN());
    volume.x.push_back(t_s);
    volume.y.push_back(1e9 * frame.model.removed_volume_m3);
  }
  std::vector<LineChart> panels(2);
  panels[0] = {.title = "Deepest apex below the first floor",
               .x_label = "",
               .y_label = "depth [mm]",
               .series = {std::move(depth)},
               .spans = PhaseSpans(ticks, time),
               .plot_height_px = 170.0};
  panels[1] = {.title = "Removed volume",
               .x_label = "time [s]",
               .y_label = "volume [mm³]",
               .series = {std::move(volume)},
               .plot_height_px = 170.0};
  if (!ticks.empty()) {
    const double end_s = time.At(ticks.back().stamp);
    if (end_s > 0.0)
      for (LineChart& panel : panels) panel.x = Range{0.0, end_s + 1e-3};
  }
  return Svg(panels);
}

std::string MotionChart(std::span<const TickRecord> ticks, double speed_limit_m_per_s,
                        double max_tool_in_bone_m, const TimeAxis& time) {
  const std::vector<double> t_s = time.Of(ticks);
  Series speed{.name = "", .x = t_s, .y = {}, .color = "#0072b2", .width_px = 1.1};
  Series depth{.name = "", .x = t_s, .y = {}, .color = "#d55e00", .width_px = 1.1};
  Series age{.name = "", .x = t_s, .y = {}, .color = "#009e73", .width_px = 1.1};
  for (const TickRecord& tick : ticks) {
    speed.y.push_back(1e3 * Vector3(tick.v_WT_cmd_m_per_s).norm());
    depth.y.push_back(control::HasMessage(tick) ? 1e3 * tick.tool_in_bone_m
                                                : std::numeric_limits<double>::quiet_NaN());
    // before the first frame there is no model to be old
    age.y.push_back(tick.model_frame == 0 ? std::numeric_limits<double>::quiet_NaN()
                                          : 1e3 * tick.model_age_s);
  }
  std::vector<LineChart> panels(3);
  panels[0] = {.title = "Speed of the tool's apex",
               .x_label = "",
               .y_label = "speed [mm/s]",
               .series = {std::move(speed)},
               .x_limits = Mark(time),
               .spans = PhaseSpans(ticks, time),
               .plot_height_px = 150.0};
  panels[1] = {.title = "Commanded tool beyond its collision-free pose",
               .x_label = "",
               .y_label = "in bone [mm]",
               .series = {std::move(depth)},
               .plot_height_px = 130.0};
  if (std::isfinite(max_tool_in_bone_m))
    panels[1].limits = {{1e3 * max_tool_in_bone_m, fmt::format("limit {:.3g} mm", 1e3 * max_tool_in_bone_m)}};
  panels[2] = {.title = "Age of the contact model",
               .x_label = time.label,
               .y_label = "age [ms]",
               .series = {std::move(age)},
               .plot_height_px = 130.0};
  if (speed_limit_m_per_s > 0.0)
    panels[0].limits = {
        {1e3 * speed_limit_m_per_s, fmt::format("limit {:g} mm/s", 1e3 * speed_limit_m_per_s)}};
  return Svg(panels);
}

std::string WakeupHistogram(std::span<const TickRecord> ticks) {
  std::vector<double> values;
  for (const TickRecord& tick : ticks) values.push_back(1e-3 * static_cast<double>(tick.wakeup_ns));
  return LatencyHistogram("Tick: message to wake-up", std::move(values));
}

std::string ComputeHistogram(std::span<const TickRecord> ticks) {
  std::vector<double> values;
  for (const TickRecord& tick : ticks) values.push_back(1e-3 * static_cast<double>(tick.compute_ns));
  return LatencyHistogram("Tick: wake-up to answer", std::move(values));
}

std::string FrameTimeHistogram(std::span<const FrameRecord> frames) {
  std::vector<double> values;
  for (const FrameRecord& frame : frames) values.push_back(1e-3 * static_cast<double>(frame.duration_ns));
  return LatencyHistogram("Simulation frame", std::move(values));
}

}  // namespace osteon::app
