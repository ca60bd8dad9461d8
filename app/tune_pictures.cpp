#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "app/report/level_map.h"
#include "app/report/svg_text.h"
#include "app/tune_result.h"

namespace osteon::app {
namespace {

constexpr double kFastest_per_s = 8.0;  // decay: beyond, a hand takes it for still
constexpr const char* kPredictedColor = "#1b1f24";
constexpr const char* kChosenColor = "#d55e00";

// What is zero is unstable without a wall: no point. Nor has what is stable as far as was looked, in a map.
Series Curve(const std::vector<TuneBoundary>& boundaries, double TuneBoundary::*what, double unit,
             const std::string& name, const std::string& color, Marker marker,
             double below = std::numeric_limits<double>::infinity()) {
  Series series{
      .name = name, .color = color, .width_px = marker == Marker::kNone ? 2.0 : 0.0, .marker = marker};
  for (const TuneBoundary& b : boundaries) {
    series.x.push_back(b.damping_Ns_per_m);
    series.y.push_back(b.*what > 0.0 && b.*what < below ? unit * (b.*what)
                                                        : std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

}  // namespace

std::string MapSvg(const TuneResult& r) {
  std::vector<LevelMap> panels;
  for (std::size_t k = 0; k < r.maps.size(); ++k) {
    const TuneMap& map = r.maps[k];
    const auto& boundaries = k == 0 ? r.human : r.stiffest;
    panels.push_back({.title = map.title,
                      .x_label = "drag of the virtual tool [N s/m]",
                      .y_label = "stiffness of the wall [N/m]",
                      .x = {map.damping_from, map.damping_to},
                      .y = {map.wall_from, map.wall_to},
                      .nx = map.dampings,
                      .ny = map.walls,
                      .values = map.decay_per_s,
                      .curves = {Curve(boundaries, &TuneBoundary::predicted_N_per_m, 1.0, "", kPredictedColor,
                                       Marker::kNone, r.most_wall_N_per_m),
                                 Curve(boundaries, &TuneBoundary::simulated_N_per_m, 1.0, "", "#ffffff",
                                       Marker::kCircle, r.most_wall_N_per_m),
                                 Series{.x = {r.recommended.damping_Ns_per_m},
                                        .y = {r.task.wall_N_per_m},
                                        .color = kChosenColor,
                                        .width_px = 0.0,
                                        .marker = Marker::kDiamond}}});
  }
  return LevelMapSvg(
      panels, {.label = "decay of the slowest motion [1/s]", .min = 0.0, .max = kFastest_per_s},
      fmt::format("Stability at {:.3g} kg", r.recommended.mass_kg),
      {{.text = "boundary, predicted", .color = kPredictedColor},
       {.text = "simulated", .color = kAxisColor, .mark = LegendEntry::Mark::kNone, .marker = Marker::kRing},
       {.text = "recommended drag, the cell's wall",
        .color = kChosenColor,
        .mark = LegendEntry::Mark::kNone,
        .marker = Marker::kDiamond},
       {.text = "grows", .color = "#dfe2e6", .mark = LegendEntry::Mark::kFill}});
}

std::string WidthSvg(const TuneResult& r) {
  LineChart chart{.title = fmt::format("Greatest wall stiffness at {:.3g} kg", r.recommended.mass_kg),
                  .x_label = "drag of the virtual tool [N s/m]",
                  .y_label = "stiffness of the wall [kN/m]",
                  .y = Range{10.0, 1e-3 * r.most_wall_N_per_m},
                  .y_from_zero = false,
                  .log_x = true,
                  .log_y = true,
                  .plot_height_px = 330.0};
  const std::pair<const std::vector<TuneBoundary>*, std::string> groups[]{
      {&r.firm, "a firm hand"},
      {&r.human, fmt::format("grips up to {:g} N/m", r.task.human_grip_N_per_m)},
      {&r.stiffest, fmt::format("up to {:g} N/m", r.task.stiffest_grip_N_per_m)}};
  for (std::size_t k = 0; k < std::size(groups); ++k) {
    const auto& [boundaries, name] = groups[k];
    const std::string color = kPalette[k];
    chart.series.push_back(
        Curve(*boundaries, &TuneBoundary::predicted_N_per_m, 1e-3, name, color, Marker::kNone));
    chart.series.push_back(
        Curve(*boundaries, &TuneBoundary::simulated_N_per_m, 1e-3, "simulated", color, Marker::kRing));
    chart.series.push_back(
        Curve(*boundaries, &TuneBoundary::degraded_N_per_m, 1e-3, "lost and late", color, Marker::kCross));
  }
  chart.limits = {{.value = 1e-3 * r.task.wall_N_per_m, .label = "the cell's"}};
  chart.x_limits = {{.value = r.recommended.damping_Ns_per_m, .label = "recommended"}};
  return Svg(chart);
}

std::string TradeSvg(const TuneResult& r) {
  LineChart chart{.title = fmt::format("Least drag, gain margin {:g}", r.task.margin),
                  .x_label = "mass of the virtual tool [kg]",
                  .y_label = "drag [N s/m]",
                  .plot_height_px = 260.0};
  Series human{.name = fmt::format("grips up to {:g} N/m", r.task.human_grip_N_per_m),
               .marker = Marker::kCircle};
  Series stiffest{.name = fmt::format("up to {:g} N/m", r.task.stiffest_grip_N_per_m),
                  .marker = Marker::kSquare};
  for (const TuneTrade& trade : r.trade) {
    human.x.push_back(trade.mass_kg);
    human.y.push_back(trade.human_Ns_per_m);
    stiffest.x.push_back(trade.mass_kg);
    stiffest.y.push_back(trade.stiffest_Ns_per_m);
  }
  chart.series = {human, stiffest};
  chart.series.push_back({.name = "the cell's own gains",
                          .x = {r.task.loop.mass_kg},
                          .y = {r.task.loop.damping_Ns_per_m},
                          .color = kMutedColor,
                          .width_px = 0.0,
                          .marker = Marker::kCross});
  if (r.Stands())
    chart.series.push_back({.name = "recommended",
                            .x = {r.recommended.mass_kg},
                            .y = {r.recommended.damping_Ns_per_m},
                            .color = kChosenColor,
                            .width_px = 0.0,
                            .marker = Marker::kDiamond});
  chart.limits = {{.value = r.task.most_drag_Ns_per_m, .label = "light"}};
  chart.x_limits = {{.value = r.task.most_mass_kg, .label = "light"}};
  return Svg(chart);
}

}  // namespace osteon::app
