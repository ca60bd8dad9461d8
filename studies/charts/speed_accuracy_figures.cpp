#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "report/pareto.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/bench/method_engine.h"
#include "studies/charts/chart_speed_accuracy.h"

namespace osteon::app {
namespace {

constexpr double kFloor = 1e-4;  // smallest value drawn on a logarithmic axis, in the axis's unit

// Text column on GitHub: letters are not scaled below their size there.
constexpr double kPageWidth_px = 830.0;

struct MethodStyle {
  const char* method;
  const char* name;
  Marker marker;
  const char* color;
};
constexpr std::array<MethodStyle, 7> kMethodStyles{
    {{"ours", "ours", Marker::kCircle, kPalette[0]},
     {"split", "ours, split", Marker::kRing, kPalette[0]},
     {"stamps", "stamps at discrete poses", Marker::kDown, kPalette[5]},
     {"paper", "paper, corrected", Marker::kSquare, kPalette[2]},
     {"paper-printed", "paper, as printed", Marker::kDiamond, kPalette[4]},
     {"voxel", "voxels, finger-proxy", Marker::kTriangle, kPalette[1]},
     {"pointshell", "voxmap-pointshell", Marker::kCross, kPalette[3]}}};

double Of(const simulation::WorkloadScores& scores, ChartFigure figure) {
  switch (figure) {
    case ChartFigure::kDepth:
      return scores.depth_error_m * 1e3;
    case ChartFigure::kVolume:
      return scores.volume_error;
    case ChartFigure::kForce:
      return scores.force.force_relative;
    case ChartFigure::kRipple:
      return scores.ripple;
  }
  return 0.0;
}

template <typename ValueOf>
SeedRange RangeOverSeeds(const SpeedAccuracyPoint& point, const ValueOf& value_of) {
  std::vector<double> values;
  for (const SeedScores& seed : point.seeds) values.push_back(value_of(seed));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  return {.median = median, .low = values.front(), .high = values.back()};
}

std::string Count(double count) {
  if (count < 1e4) return fmt::format("{:.1f}k", count * 1e-3);
  if (count < 1e6) return fmt::format("{:.0f}k", count * 1e-3);
  return fmt::format("{:.1f}M", count * 1e-6);
}

std::string LabelOf(const SpeedAccuracyPoint& point) {
  const std::string count = Count(static_cast<double>(point.spheres));
  if (WantsVoxels(point.method)) return fmt::format("{}, h {:.3g}", count, 2e3 * point.r_max_m);
  return fmt::format("{}, r {:.2g}", count, 1e3 * point.r_max_m);
}

LineChart Panel(const SpeedAccuracyResult& result, ChartFigure figure) {
  LineChart chart{.x_label = "frame time, median [µs]",
                  .log_x = true,
                  .log_y = true,
                  .legend = false,
                  .plot_height_px = 330.0};
  chart.x_limits.push_back({.value = 1000.0, .label = "1 ms"});
  switch (figure) {
    case ChartFigure::kDepth:
      chart.title = "Depth of the cut";
      chart.y_label = "error [mm]";
      chart.limits.push_back({.value = 0.1, .label = "0.1 mm"});
      break;
    case ChartFigure::kVolume:
      chart.title = "Removed volume";
      chart.y_label = "relative error";
      break;
    case ChartFigure::kForce:
      chart.title = "Force";
      chart.y_label = "relative error, rms";
      chart.limits.push_back({.value = 0.07, .label = "7 %"});
      break;
    case ChartFigure::kRipple:
      chart.title = "Ripple of the force, 5 to 500 Hz";
      chart.y_label = "rms over the exact mean";
      chart.limits.push_back({.value = 0.07, .label = "7 %"});
      break;
  }
  std::vector<CostPoint> costs;
  for (const SpeedAccuracyPoint& point : result.points)
    costs.push_back({FrameTimeOf(point).median, std::max(kFloor, SeedRangeOf(point, figure).median)});
  const std::vector<bool> front = OnParetoFront(costs);

  double x_least = HUGE_VAL, x_most = 0.0, y_least = HUGE_VAL, y_most = 0.0;
  std::vector<CostPoint> steps;
  for (const MethodStyle& style : kMethodStyles) {
    // one line per method, in the order of its resolutions; its points on the front strong, the others pale
    Series line{.name = style.name, .color = style.color, .width_px = 1.0, .opacity = 0.45};
    Series strong{.color = style.color, .width_px = 0.0, .marker = style.marker};
    Series pale{.color = style.color, .width_px = 0.0, .marker = style.marker, .opacity = 0.4};
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      const SpeedAccuracyPoint& point = result.points[i];
      if (point.method != style.method || !(costs[i].x > 0.0)) continue;
      const SeedRange spread = SeedRangeOf(point, figure);
      line.x.push_back(costs[i].x);
      line.y.push_back(costs[i].y);
      Series& drawn = front[i] ? strong : pale;
      drawn.x.push_back(costs[i].x);
      drawn.y.push_back(costs[i].y);
      drawn.y_low.push_back(std::max(kFloor, spread.low));
      drawn.y_high.push_back(std::max(kFloor, spread.high));
      drawn.labels.push_back(LabelOf(point));
      if (front[i]) steps.push_back(costs[i]);
      x_least = std::min(x_least, costs[i].x);
      x_most = std::max(x_most, costs[i].x);
      y_least = std::min(y_least, drawn.y_low.back());
      y_most = std::max(y_most, drawn.y_high.back());
    }
    chart.series.push_back(std::move(line));
    chart.series.push_back(std::move(pale));
    chart.series.push_back(std::move(strong));
  }
  // the front: the best error that is possible within a time
  std::sort(steps.begin(), steps.end(), [](const CostPoint& a, const CostPoint& b) { return a.x < b.x; });
  Series stairs{.color = kTextColor, .width_px = 1.6};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (i > 0) {
      stairs.x.push_back(steps[i].x);
      stairs.y.push_back(steps[i - 1].y);
    }
    stairs.x.push_back(steps[i].x);
    stairs.y.push_back(steps[i].y);
  }
  chart.series.insert(chart.series.begin(), std::move(stairs));
  for (const LimitLine& limit : chart.limits) {
    y_least = std::min(y_least, limit.value);
    y_most = std::max(y_most, limit.value);
  }
  if (x_most > 0.0) {
    chart.x = Range{std::min(x_least, 700.0) / 1.5, std::max(x_most, 1500.0) * 1.6};
    chart.y = Range{y_least / 1.6, y_most * 1.6};
  }
  return chart;
}

std::vector<LegendEntry> LegendOf(const SpeedAccuracyResult& result) {
  std::vector<LegendEntry> legend;
  for (const MethodStyle& style : kMethodStyles)
    if (std::ranges::any_of(result.points, [&](const auto& point) { return point.method == style.method; }))
      legend.push_back({.text = style.name,
                        .color = style.color,
                        .mark = LegendEntry::Mark::kNone,
                        .marker = style.marker});
  legend.push_back({.text = "best within a time", .color = kTextColor});
  return legend;
}

nlohmann::json TaskJson(const simulation::WorkloadScores& s) {
  return {{"depth_error_mm", s.depth_error_m * 1e3},
          {"depth_error_se_mm", s.depth_error_se_m * 1e3},
          {"lost_mm", s.lost_m * 1e3},
          {"left_mm", s.left_m * 1e3},
          {"probe_p95_mm", s.probe_p95_m * 1e3},
          {"volume_error", s.volume_error},
          {"force_error", s.force.force_relative},
          {"torque_error_Nm", s.force.torque_rms_Nm},
          {"normal_error_deg", s.force.normal_rms_deg},
          {"force_jump_N_per_ms", s.force.force_jump_N_per_ms},
          {"torque_jump_Nm_per_ms", s.force.torque_jump_Nm_per_ms},
          {"normal_jump_deg_per_ms", s.force.normal_jump_deg_per_ms},
          {"touched", s.force.touched},
          {"ripple", s.ripple}};
}

nlohmann::json SeedRangeJson(const SeedRange& spread) { return {spread.low, spread.high}; }

}  // namespace

SeedRange SeedRangeOf(const SpeedAccuracyPoint& point, ChartFigure figure) {
  return RangeOverSeeds(point, [figure](const SeedScores& seed) { return Of(seed.scores, figure); });
}

SeedRange FrameTimeOf(const SpeedAccuracyPoint& point) {
  return RangeOverSeeds(point, [](const SeedScores& seed) { return seed.frame_us.p50_us; });
}

std::string SpeedAccuracySvg(const SpeedAccuracyResult& result) {
  const std::array panels{Panel(result, ChartFigure::kDepth), Panel(result, ChartFigure::kVolume),
                          Panel(result, ChartFigure::kForce), Panel(result, ChartFigure::kRipple)};
  return SvgGrid(panels, 1, "Speed and accuracy of cutting methods", LegendOf(result), kPageWidth_px);
}

std::string DepthOverTimeSvg(const SpeedAccuracyResult& result) {
  const std::array panels{Panel(result, ChartFigure::kDepth)};
  return SvgGrid(panels, 1, "", LegendOf(result), kPageWidth_px);
}

std::string SpeedAccuracyJson(const SpeedAccuracyResult& result) {
  nlohmann::json json{{"schema", "osteon.chart.speed-accuracy/1"},
                      {"subcommand", "chart speed-accuracy"},
                      {"device", result.device},
                      {"machine", result.machine},
                      {"left_out", result.left_out},
                      {"points", nlohmann::json::array()}};
  for (const SpeedAccuracyPoint& point : result.points) {
    const auto over = [&](const auto& value) { return RangeOverSeeds(point, value); };
    nlohmann::json entry{
        {"method", point.method},
        {"device", point.device},
        {"spheres", point.spheres},
        {"r_max_mm", point.r_max_m * 1e3},
        {"length_mm", point.length_m * 1e3},
        {"seeds", point.seeds.size()},
        {"frame_us_p50", FrameTimeOf(point).median},
        {"frame_us_p999", over([](const SeedScores& s) { return s.frame_us.p999_us; }).median},
        {"depth_error_mm", SeedRangeOf(point, ChartFigure::kDepth).median},
        {"depth_error_range_mm", SeedRangeJson(SeedRangeOf(point, ChartFigure::kDepth))},
        {"volume_error", SeedRangeOf(point, ChartFigure::kVolume).median},
        {"volume_error_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kVolume))},
        {"force_error", SeedRangeOf(point, ChartFigure::kForce).median},
        {"force_error_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kForce))},
        {"ripple", SeedRangeOf(point, ChartFigure::kRipple).median},
        {"ripple_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kRipple))},
        {"normal_error_deg", over([](const SeedScores& s) { return s.scores.force.normal_rms_deg; }).median},
        {"lost_mm", over([](const SeedScores& s) { return s.scores.lost_m * 1e3; }).median},
        {"left_mm", over([](const SeedScores& s) { return s.scores.left_m * 1e3; }).median},
        {"probe_p95_mm", over([](const SeedScores& s) { return s.scores.probe_p95_m * 1e3; }).median},
        {"tasks", nlohmann::json::object()}};
    for (const auto& [task, scores] : point.tasks) entry["tasks"][task] = TaskJson(scores);
    json["points"].push_back(std::move(entry));
  }
  return ResultText(Judge(result), json);
}

}  // namespace osteon::app
