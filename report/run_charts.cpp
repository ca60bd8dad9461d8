#include "report/run_charts.h"

#include <cmath>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "report/svg_plot.h"

namespace osteon::report {
namespace {

using control::Phase;

/// Returns the parts of the run in which the loop did not render, with names.
std::vector<NamedSpan> PhaseSpans(const RunCurves& run, const TimeAxis& time) {
  std::vector<NamedSpan> spans;
  for (const PhaseStretch& stretch : run.phases) {
    const double from_s = time.At(stretch.begin);
    const double to_s = time.At(stretch.end);
    switch (stretch.phase) {
      case Phase::kWaiting:
        spans.push_back({from_s, to_s, stretch.paused ? "paused" : "waiting for the arm", "#e6eef5"});
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
  }
  return spans;
}

/// Returns a series of the given style with the points of a curve.
Series WithPoints(Series series, const ThinCurve& curve, const TimeAxis& time) {
  std::tie(series.x, series.y) = curve.Columns(time.zero);
  return series;
}

/// Returns the vertical line at time 0, labelled with the axis's mark; none if the mark is empty.
std::vector<LimitLine> MarkAtZero(const TimeAxis& time) {
  return time.mark.empty() ? std::vector<LimitLine>{} : std::vector<LimitLine>{{0.0, time.mark}};
}

/// Plots durations in µs on logarithmic axes; empty text if none is above 0.
std::string LatencyHistogram(std::string title, const DurationCounts& durations) {
  Histogram histogram{
      .title = std::move(title), .x_label = "time [µs]", .log_x = true, .log_y = true, .unit = "µs"};
  bool measured = false;
  durations.ForEach([&](rt::Nanoseconds duration, std::uint64_t times) {
    measured |= duration > 0;
    histogram.values.push_back(1e-3 * static_cast<double>(duration));
    histogram.times.push_back(times);
  });
  return measured ? Svg(histogram) : std::string();
}

}  // namespace

std::string ForceChart(const RunCurves& run, double force_limit_N, const TimeAxis& time) {
  LineChart chart{
      .x_label = time.label,
      .y_label = "force [N]",
      .series = {WithPoints({.name = "hand's force (sensor)", .color = "#009e73", .width_px = 1.1},
                            run.hand_N, time),
                 WithPoints({.name = "rendered coupling force", .color = "#0072b2"}, run.coupling_N, time),
                 WithPoints(
                     {.name = "its part along the tool (resisting)", .color = "#d55e00", .width_px = 1.1},
                     run.axial_N, time)},
      .limits = {{force_limit_N, fmt::format("limit {:g} N", force_limit_N)}},
      .x_limits = MarkAtZero(time),
      .spans = PhaseSpans(run, time),
      .zooms = true,
      .plot_height_px = 270.0};
  if (!run.wrench_cut) return Svg(chart);

  // how far limits reduced the rendered wrench
  LineChart shares{
      .title = "Share of the coupling's wrench",
      .x_label = time.label,
      .y_label = "share [%]",
      .y = Range{0.0, 105.0},
      .series = {WithPoints({.name = "that the arm's torques can hold", .color = "#cc79a7", .width_px = 1.1},
                            run.arm_percent, time),
                 WithPoints({.name = "rendered", .color = "#0072b2"}, run.rendered_percent, time)},
      .plot_height_px = 110.0};
  chart.x_label.clear();
  return Svg(std::vector<LineChart>{std::move(chart), std::move(shares)});
}

std::string ProgressChart(const RunCurves& run) {
  const TimeAxis time = FromFirst(run);
  std::vector<LineChart> panels(2);
  panels[0] = {
      .title = "Apex below the first floor",
      .x_label = "",
      .y_label = "depth [mm]",
      .series = {WithPoints({.name = "commanded, in bone", .color = "#cc79a7", .width_px = 1.1},
                            run.commanded_depth_mm, time),
                 WithPoints({.name = "proxy, the deepest so far", .color = "#0072b2", .width_px = 1.8},
                            run.depth_mm, time)},
      .spans = PhaseSpans(run, time),
      .zooms = true,
      .plot_height_px = 170.0};
  panels[1] = {.title = "Removed volume",
               .x_label = "time [s]",
               .y_label = "volume [mm³]",
               .series = {WithPoints({.color = "#d55e00", .width_px = 1.8}, run.volume_mm3, time)},
               .plot_height_px = 170.0};
  const double end_s = run.last_tick ? time.At(*run.last_tick) : 0.0;
  if (end_s > 0.0)
    for (LineChart& panel : panels) panel.x = Range{0.0, end_s + 1e-3};
  return Svg(panels);
}

std::string MotionChart(const RunCurves& run, double speed_limit_m_per_s, double max_tool_in_bone_m,
                        const TimeAxis& time) {
  std::vector<LineChart> panels(3);
  panels[0] = {.title = "Speed of the tool's apex",
               .x_label = "",
               .y_label = "speed [mm/s]",
               .series = {WithPoints({.color = "#0072b2", .width_px = 1.1}, run.speed_mm_per_s, time)},
               .x_limits = MarkAtZero(time),
               .spans = PhaseSpans(run, time),
               .zooms = true,
               .plot_height_px = 150.0};
  panels[1] = {.title = "Commanded tool beyond its collision-free pose",
               .x_label = "",
               .y_label = "in bone [mm]",
               .series = {WithPoints({.color = "#d55e00", .width_px = 1.1}, run.in_bone_mm, time)},
               .plot_height_px = 130.0};
  if (std::isfinite(max_tool_in_bone_m))
    panels[1].limits = {{1e3 * max_tool_in_bone_m, fmt::format("limit {:.3g} mm", 1e3 * max_tool_in_bone_m)}};
  panels[2] = {.title = "Age of the contact model",
               .x_label = time.label,
               .y_label = "age [ms]",
               .series = {WithPoints({.color = "#009e73", .width_px = 1.1}, run.model_age_ms, time)},
               .plot_height_px = 130.0};
  if (speed_limit_m_per_s > 0.0)
    panels[0].limits = {
        {1e3 * speed_limit_m_per_s, fmt::format("limit {:g} mm/s", 1e3 * speed_limit_m_per_s)}};
  return Svg(panels);
}

std::string ComplianceChart(const RunCurves& run) {
  const TimeAxis time = FromFirst(run);
  std::vector<LineChart> panels;
  const auto add = [&](bool acts, const char* title, const char* label, const char* color,
                       const ThinCurve& curve) {
    if (acts)
      panels.push_back({.title = title,
                        .x_label = "",
                        .y_label = label,
                        .series = {WithPoints({.color = color, .width_px = 1.1}, curve, time)},
                        .zooms = true,
                        .plot_height_px = 130.0});
  };
  add(run.bends, "The tool bends", "head aside [mm]", "#0072b2", run.bend_mm);
  add(run.has_layer, "Surface layer", "gives way [mm]", "#d55e00", run.layer_mm);
  add(run.mount_moves, "Bone on its mount", "moves [mm]", "#009e73", run.mount_mm);
  if (panels.empty()) return {};
  panels.front().spans = PhaseSpans(run, time);
  panels.back().x_label = time.label;
  return Svg(panels);
}

std::string WakeupHistogram(const RunCurves& run) {
  return LatencyHistogram("Tick: message to wake-up", run.wakeup);
}

std::string ComputeHistogram(const RunCurves& run) {
  return LatencyHistogram("Tick: wake-up to answer", run.compute);
}

std::string FrameTimeHistogram(const RunCurves& run) {
  return LatencyHistogram("Simulation frame", run.frame);
}

}  // namespace osteon::report
