#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "report/pareto.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"
#include "studies/bench/method_engine.h"
#include "studies/charts/chart_speed_accuracy.h"

// Figures, pictures, tables and JSON of the chart's result (chart_speed_accuracy.h).

namespace osteon::studies {
namespace {

constexpr double kFloor = 1e-4;  // smallest value drawn on a logarithmic axis, in the axis's unit

// Width of GitHub's text column: at this width the picture's letters are not scaled down.
constexpr double kPageWidth_px = 830.0;

// How a method is drawn, and its name in the legend.
struct MethodStyle {
  const char* method;
  const char* name;
  report::Marker marker;
  const char* color;
};
constexpr std::array<MethodStyle, 9> kMethodStyles{
    {{"cpu", "ours on one thread", report::Marker::kCircle, report::kPalette[5]},
     {"cpu-split", "ours on one thread, split", report::Marker::kRing, report::kPalette[5]},
     {"ours", "ours", report::Marker::kCircle, report::kPalette[0]},
     {"split", "ours, split", report::Marker::kRing, report::kPalette[0]},
     {"stamps", "stamps at discrete poses", report::Marker::kDown, report::kMutedColor},
     {"paper", "paper, corrected", report::Marker::kSquare, report::kPalette[2]},
     {"paper-printed", "paper, as printed", report::Marker::kDiamond, report::kPalette[4]},
     {"voxel", "voxels, finger-proxy", report::Marker::kTriangle, report::kPalette[1]},
     {"pointshell", "voxmap-pointshell", report::Marker::kCross, report::kPalette[3]}}};

// An error of the scores in the unit of its panel: depth in mm, direction in degrees, the others relative.
double ErrorOf(const simulation::WorkloadScores& scores, ChartFigure figure) {
  switch (figure) {
    case ChartFigure::kDepth:
      return scores.depth_error_m * 1e3;
    case ChartFigure::kVolume:
      return scores.volume_error;
    case ChartFigure::kForce:
      return scores.force.force_relative;
    case ChartFigure::kNormal:
      return scores.force.normal_rms_deg;
    case ChartFigure::kRipple:
      return scores.ripple;
  }
  return 0.0;
}

// Median, least and greatest of a value over the point's seeds; zeros without seeds.
template <typename ValueOf>
SeedRange RangeOverSeeds(const SpeedAccuracyPoint& point, const ValueOf& value_of) {
  std::vector<double> values;
  for (const SeedScores& seed : point.seeds) values.push_back(value_of(seed));
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const double median = 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
  return {.median = median, .low = values.front(), .high = values.back()};
}

// "1.2k", "35k", "1.2M".
std::string CountText(double count) {
  if (count < 1e4) return fmt::format("{:.1f}k", count * 1e-3);
  if (count < 1e6) return fmt::format("{:.0f}k", count * 1e-3);
  return fmt::format("{:.1f}M", count * 1e-6);
}

// Label of a point: its number of spheres, and their largest radius in mm; for voxels h, their edge in mm.
std::string LabelOf(const SpeedAccuracyPoint& point) {
  const std::string count = CountText(static_cast<double>(point.spheres));
  if (WantsVoxels(point.method)) return fmt::format("{}, h {:.3g}", count, 2e3 * point.r_max_m);
  return fmt::format("{}, r {:.2g}", count, 1e3 * point.r_max_m);
}

// The panel of one error over the frame time, both logarithmic.
report::LineChart Panel(const SpeedAccuracyResult& result, ChartFigure figure, ChartTime time) {
  report::LineChart chart{.x_label = time == ChartTime::kMedian ? "frame time, median [µs]"
                                                                : "frame time, 99.9th percentile [µs]",
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
    case ChartFigure::kNormal:
      chart.title = "Direction of the force";
      chart.y_label = "error, rms [°]";
      break;
    case ChartFigure::kRipple:
      chart.title = "Ripple of the force, 5 to 500 Hz";
      chart.y_label = "rms over the exact mean";
      chart.limits.push_back({.value = 0.07, .label = "7 %"});
      break;
  }
  std::vector<report::CostPoint> costs;
  for (const SpeedAccuracyPoint& point : result.points)
    costs.push_back({FrameTimeOf(point, time).median, std::max(kFloor, SeedRangeOf(point, figure).median)});
  const std::vector<bool> front = report::OnParetoFront(costs);

  double x_least = HUGE_VAL, x_most = 0.0, y_least = HUGE_VAL, y_most = 0.0;
  std::vector<report::CostPoint> front_points;
  for (const MethodStyle& style : kMethodStyles) {
    // one line per method, in the order of its resolutions; points on the front are drawn strong, other
    // points pale
    report::Series line{.name = style.name, .color = style.color, .width_px = 1.0, .opacity = 0.45};
    report::Series strong{.color = style.color, .width_px = 0.0, .marker = style.marker};
    report::Series pale{.color = style.color, .width_px = 0.0, .marker = style.marker, .opacity = 0.4};
    for (std::size_t i = 0; i < result.points.size(); ++i) {
      const SpeedAccuracyPoint& point = result.points[i];
      if (point.method != style.method || !(costs[i].x > 0.0)) continue;
      const SeedRange spread = SeedRangeOf(point, figure);
      line.x.push_back(costs[i].x);
      line.y.push_back(costs[i].y);
      report::Series& drawn = front[i] ? strong : pale;
      drawn.x.push_back(costs[i].x);
      drawn.y.push_back(costs[i].y);
      drawn.y_low.push_back(std::max(kFloor, spread.low));
      drawn.y_high.push_back(std::max(kFloor, spread.high));
      drawn.labels.push_back(LabelOf(point));
      if (front[i]) front_points.push_back(costs[i]);
      x_least = std::min(x_least, costs[i].x);
      x_most = std::max(x_most, costs[i].x);
      y_least = std::min(y_least, drawn.y_low.back());
      y_most = std::max(y_most, drawn.y_high.back());
    }
    chart.series.push_back(std::move(line));
    chart.series.push_back(std::move(pale));
    chart.series.push_back(std::move(strong));
  }
  // the front: the smallest error that any point reaches within a time
  std::sort(front_points.begin(), front_points.end(),
            [](const report::CostPoint& a, const report::CostPoint& b) { return a.x < b.x; });
  report::Series stairs{.color = report::kTextColor, .width_px = 1.6};
  for (std::size_t i = 0; i < front_points.size(); ++i) {
    if (i > 0) {
      stairs.x.push_back(front_points[i].x);
      stairs.y.push_back(front_points[i - 1].y);
    }
    stairs.x.push_back(front_points[i].x);
    stairs.y.push_back(front_points[i].y);
  }
  chart.series.insert(chart.series.begin(), std::move(stairs));
  for (const report::LimitLine& limit : chart.limits) {
    y_least = std::min(y_least, limit.value);
    y_most = std::max(y_most, limit.value);
  }
  if (x_most > 0.0) {
    chart.x = report::Range{std::min(x_least, 700.0) / 1.5, std::max(x_most, 1500.0) * 1.6};
    chart.y = report::Range{y_least / 1.6, y_most * 1.6};
  }
  return chart;
}

std::vector<report::LegendEntry> LegendOf(const SpeedAccuracyResult& result) {
  std::vector<report::LegendEntry> legend;
  for (const MethodStyle& style : kMethodStyles)
    if (std::ranges::any_of(result.points, [&](const auto& point) { return point.method == style.method; }))
      legend.push_back({.text = style.name,
                        .color = style.color,
                        .mark = report::LegendEntry::Mark::kNone,
                        .marker = style.marker});
  legend.push_back({.text = "best within a time", .color = report::kTextColor});
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

// An error's key in JSON, and its name in tables.
const char* KeyOf(ChartFigure figure) {
  switch (figure) {
    case ChartFigure::kDepth:
      return "depth";
    case ChartFigure::kVolume:
      return "volume";
    case ChartFigure::kForce:
      return "force";
    case ChartFigure::kNormal:
      return "normal";
    case ChartFigure::kRipple:
      return "ripple";
  }
  return "";
}

// "voxel 0.5 mm".
std::string NameOf(const SpeedAccuracyPoint& point) {
  return fmt::format("{} {:g} mm", point.method, point.length_m * 1e3);
}

// For each error: how the other methods' points compare with ours (CompareWithOurs).
nlohmann::json DominanceJson(const SpeedAccuracyResult& result, ChartTime time) {
  nlohmann::json json;
  for (const ChartFigure figure : kChartFigures) {
    const Dominance found = DominanceOf(result, figure, time);
    const auto point_json = [&](std::size_t i) -> nlohmann::json {
      const SpeedAccuracyPoint& point = result.points[i];
      return {{"method", point.method},
              {"length_mm", point.length_m * 1e3},
              {"frame_us", FrameTimeOf(point, time).median},
              {"error", SeedRangeOf(point, figure).median}};
    };
    const auto points_json = [&](const std::vector<std::size_t>& points) {
      nlohmann::json list = nlohmann::json::array();
      for (const std::size_t i : points) list.push_back(point_json(i));
      return list;
    };
    nlohmann::json beaten = nlohmann::json::array();
    for (const BeatenPoint& point : found.beaten)
      beaten.push_back({{"ours", point_json(point.ours)}, {"by", points_json(point.by)}});
    json[KeyOf(figure)] = {{"ours_measured", found.ours_measured},
                           {"beat_all_ours", points_json(found.beat_all_ours)},
                           {"beaten", std::move(beaten)},
                           {"ahead", points_json(found.ahead)},
                           {"faster_than_all_ours", points_json(found.faster_than_all_ours)}};
  }
  return json;
}

// [least, greatest].
nlohmann::json SeedRangeJson(const SeedRange& spread) { return {spread.low, spread.high}; }

}  // namespace

SeedRange SeedRangeOf(const SpeedAccuracyPoint& point, ChartFigure figure) {
  return RangeOverSeeds(point, [figure](const SeedScores& seed) { return ErrorOf(seed.scores, figure); });
}

SeedRange FrameTimeOf(const SpeedAccuracyPoint& point, ChartTime time) {
  return RangeOverSeeds(point, [time](const SeedScores& seed) {
    return time == ChartTime::kMedian ? seed.frame_us.p50_us : seed.frame_us.p999_us;
  });
}

Dominance DominanceOf(const SpeedAccuracyResult& result, ChartFigure figure, ChartTime time) {
  std::vector<RivalPoint> points;
  for (const SpeedAccuracyPoint& point : result.points)
    points.push_back({.cost = {FrameTimeOf(point, time).median, SeedRangeOf(point, figure).median},
                      .ours = IsOurs(point.method)});
  return CompareWithOurs(points);
}

std::vector<std::vector<std::string>> DominanceTable(const SpeedAccuracyResult& result, ChartTime time) {
  std::vector<std::vector<std::string>> rows{{"error", "faster and more exact than every one of ours",
                                              "faster and more exact than one of ours",
                                              "ahead of ours within its time", "faster than all of ours"}};
  for (const ChartFigure figure : kChartFigures) {
    const Dominance found = DominanceOf(result, figure, time);
    const auto names = [&](const std::vector<std::size_t>& points) {
      std::vector<std::string> texts;
      for (const std::size_t i : points) texts.push_back(NameOf(result.points[i]));
      if (!found.ours_measured) return std::string("ours was not measured");
      return texts.empty() ? std::string("none") : fmt::format("{}", fmt::join(texts, ", "));
    };
    std::vector<std::size_t> beating;  // points that beat at least one of ours
    for (std::size_t i = 0; i < result.points.size(); ++i)
      if (std::ranges::any_of(found.beaten,
                              [&](const BeatenPoint& p) { return std::ranges::count(p.by, i) > 0; }))
        beating.push_back(i);
    rows.push_back({KeyOf(figure), names(found.beat_all_ours), names(beating), names(found.ahead),
                    names(found.faster_than_all_ours)});
  }
  return rows;
}

std::string SpeedAccuracySvg(const SpeedAccuracyResult& result, ChartTime time) {
  std::vector<report::LineChart> panels;
  for (const ChartFigure figure : kChartFigures) panels.push_back(Panel(result, figure, time));
  return report::SvgGrid(panels, 1, "Speed and accuracy of cutting methods", LegendOf(result), kPageWidth_px);
}

std::string DepthOverTimeSvg(const SpeedAccuracyResult& result) {
  const std::array panels{Panel(result, ChartFigure::kDepth, ChartTime::kMedian)};
  return report::SvgGrid(panels, 1, "", LegendOf(result), kPageWidth_px);
}

std::string SpeedAccuracyJson(const SpeedAccuracyResult& result) {
  nlohmann::json json{{"schema", "osteon.chart.speed-accuracy/1"},
                      {"subcommand", "chart speed-accuracy"},
                      {"device", result.device},
                      {"machine", result.machine},
                      {"left_out", result.left_out},
                      {"dominance",
                       {{"median", DominanceJson(result, ChartTime::kMedian)},
                        {"p999", DominanceJson(result, ChartTime::kWorst)}}},
                      {"points", nlohmann::json::array()}};
  for (const SpeedAccuracyPoint& point : result.points) {
    const auto over_seeds = [&](const auto& value) { return RangeOverSeeds(point, value); };
    nlohmann::json entry{
        {"method", point.method},
        {"device", point.device},
        {"spheres", point.spheres},
        {"r_max_mm", point.r_max_m * 1e3},
        {"length_mm", point.length_m * 1e3},
        {"seeds", point.seeds.size()},
        {"frame_us_p50", FrameTimeOf(point).median},
        {"frame_us_p999", FrameTimeOf(point, ChartTime::kWorst).median},
        {"depth_error_mm", SeedRangeOf(point, ChartFigure::kDepth).median},
        {"depth_error_range_mm", SeedRangeJson(SeedRangeOf(point, ChartFigure::kDepth))},
        {"volume_error", SeedRangeOf(point, ChartFigure::kVolume).median},
        {"volume_error_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kVolume))},
        {"force_error", SeedRangeOf(point, ChartFigure::kForce).median},
        {"force_error_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kForce))},
        {"ripple", SeedRangeOf(point, ChartFigure::kRipple).median},
        {"ripple_range", SeedRangeJson(SeedRangeOf(point, ChartFigure::kRipple))},
        {"normal_error_deg", SeedRangeOf(point, ChartFigure::kNormal).median},
        {"lost_mm", over_seeds([](const SeedScores& s) { return s.scores.lost_m * 1e3; }).median},
        {"left_mm", over_seeds([](const SeedScores& s) { return s.scores.left_m * 1e3; }).median},
        {"probe_p95_mm", over_seeds([](const SeedScores& s) { return s.scores.probe_p95_m * 1e3; }).median},
        {"tasks", nlohmann::json::object()}};
    for (const auto& [task, scores] : point.tasks) entry["tasks"][task] = TaskJson(scores);
    json["points"].push_back(std::move(entry));
  }
  return session::ResultText(Judge(result), json);
}

}  // namespace osteon::studies
