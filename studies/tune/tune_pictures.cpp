#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "report/level_map.h"
#include "report/svg_text.h"
#include "studies/tune/tune_result.h"

namespace osteon::studies {
namespace {

// End of the map's colour scale: motion that decays faster is not felt as oscillation.
constexpr double kFastest_per_s = 8.0;
constexpr const char* kPredictedColor = "#1b1f24";
constexpr const char* kChosenColor = "#d55e00";

// Draws one stiffness of each boundary over the damping. A stiffness of 0 (unstable without a wall) and the
// stiffest wall that was tried (no boundary found) give no point. @param unit  factor from N/m to the axis'
// unit
report::Series Curve(const std::vector<TuneBoundary>& boundaries, double TuneBoundary::*stiffness,
                     double unit, const std::string& name, const std::string& color, report::Marker marker,
                     double max_N_per_m) {
  report::Series series{.name = name,
                        .color = color,
                        .width_px = marker == report::Marker::kNone ? 2.0 : 0.0,
                        .marker = marker};
  for (const TuneBoundary& b : boundaries) {
    series.x.push_back(b.damping_Ns_per_m);
    series.y.push_back(b.*stiffness > 0.0 && b.*stiffness < max_N_per_m
                           ? unit * (b.*stiffness)
                           : std::numeric_limits<double>::quiet_NaN());
  }
  return series;
}

// Marks the dampings at which even the stiffest wall that was tried is stable. Each mark is a lower bound of
// the boundary.
report::Series LowerBoundMarks(const std::vector<TuneBoundary>& boundaries, double max_N_per_m,
                               const std::string& color) {
  report::Series series{.color = color, .width_px = 0.0, .marker = report::Marker::kOpenUp};
  for (const TuneBoundary& b : boundaries)
    if (std::max({b.predicted_N_per_m, b.simulated_N_per_m, b.degraded_N_per_m}) >= max_N_per_m) {
      series.x.push_back(b.damping_Ns_per_m);
      series.y.push_back(1e-3 * max_N_per_m);
    }
  return series;
}

// A series that appears only in the legend.
report::Series LegendOnly(const std::string& name, report::Marker marker) {
  return {.name = name, .color = report::kMutedColor, .width_px = 0.0, .marker = marker};
}

// Whether mass and damping agree within 0.5 %.
bool SameGains(const TuneGains& a, double mass_kg, double damping_Ns_per_m) {
  return std::abs(a.mass_kg - mass_kg) < 0.005 * mass_kg &&
         std::abs(a.damping_Ns_per_m - damping_Ns_per_m) < 0.005 * damping_Ns_per_m;
}

}  // namespace

std::string MapSvg(const TuneResult& r) {
  std::vector<report::LevelMap> panels;
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
                                       report::Marker::kNone, r.max_wall_N_per_m),
                                 Curve(boundaries, &TuneBoundary::simulated_N_per_m, 1.0, "", kPredictedColor,
                                       report::Marker::kRing, r.max_wall_N_per_m),
                                 report::Series{.x = {r.recommended.damping_Ns_per_m},
                                                .y = {r.task.wall_N_per_m},
                                                .color = kChosenColor,
                                                .width_px = 0.0,
                                                .marker = report::Marker::kDiamond}}});
  }
  return report::LevelMapSvg(
      panels, {.label = "decay of the slowest motion [1/s]", .min = 0.0, .max = kFastest_per_s},
      fmt::format("Stability at {:.3g} kg", r.recommended.mass_kg),
      {{.text = "boundary, predicted", .color = kPredictedColor},
       {.text = "simulated",
        .color = kPredictedColor,
        .mark = report::LegendEntry::Mark::kNone,
        .marker = report::Marker::kRing},
       {.text = "recommended drag, the cell's wall",
        .color = kChosenColor,
        .mark = report::LegendEntry::Mark::kNone,
        .marker = report::Marker::kDiamond},
       {.text = "grows", .color = "#dfe2e6", .mark = report::LegendEntry::Mark::kFill}});
}

std::string WidthSvg(const TuneResult& r) {
  report::LineChart chart{.title = fmt::format("Greatest wall stiffness at {:.3g} kg", r.recommended.mass_kg),
                          .x_label = "drag of the virtual tool [N s/m]",
                          .y_label = "stiffness of the wall [kN/m]",
                          .y = report::Range{10.0, 1.3e-3 * r.max_wall_N_per_m},
                          .y_from_zero = false,
                          .log_x = true,
                          .log_y = true,
                          .plot_height_px = 330.0};
  const std::pair<const std::vector<TuneBoundary>*, std::string> groups[]{
      {&r.firm, "a firm hand"},
      {&r.human, fmt::format("grips up to {:g} N/m", r.task.human_grip_N_per_m)},
      {&r.stiffest, fmt::format("up to {:g} N/m", r.task.stiffest_grip_N_per_m)}};
  for (std::size_t k = 0; k < std::size(groups); ++k) {
    const auto* boundaries = groups[k].first;
    const auto& name = groups[k].second;
    const std::string color = report::kPalette[k];
    const auto curve = [&](double TuneBoundary::*stiffness, const std::string& legend,
                           report::Marker marker) {
      chart.series.push_back(Curve(*boundaries, stiffness, 1e-3, legend, color, marker, r.max_wall_N_per_m));
    };
    curve(&TuneBoundary::predicted_N_per_m, name, report::Marker::kNone);
    curve(&TuneBoundary::simulated_N_per_m, "", report::Marker::kRing);
    curve(&TuneBoundary::degraded_N_per_m, "", report::Marker::kCross);
    chart.series.push_back(LowerBoundMarks(*boundaries, r.max_wall_N_per_m, color));
  }
  chart.series.push_back({.name = "predicted", .color = report::kMutedColor, .width_px = 2.0});
  chart.series.push_back(LegendOnly("simulated", report::Marker::kRing));
  chart.series.push_back(LegendOnly("with commands lost and late", report::Marker::kCross));
  chart.series.push_back(
      LegendOnly("at least so much: no stiffer wall was looked at", report::Marker::kOpenUp));
  chart.limits = {{.value = 1e-3 * r.task.wall_N_per_m, .label = "the cell's wall"}};
  chart.x_limits = {{.value = r.recommended.damping_Ns_per_m, .label = "recommended"}};
  return report::Svg(chart);
}

std::string TradeSvg(const TuneResult& r) {
  report::LineChart chart{.title = fmt::format("Least drag, gain margin {:g}", r.task.margin),
                          .x_label = "mass of the virtual tool [kg]",
                          .y_label = "drag [N s/m]",
                          .plot_height_px = 260.0};
  report::Series human{.name = fmt::format("grips up to {:g} N/m", r.task.human_grip_N_per_m),
                       .marker = report::Marker::kCircle};
  report::Series stiffest{.name = fmt::format("up to {:g} N/m", r.task.stiffest_grip_N_per_m),
                          .marker = report::Marker::kSquare};
  for (const TuneTrade& trade : r.trade) {
    human.x.push_back(trade.mass_kg);
    human.y.push_back(trade.human_Ns_per_m);
    stiffest.x.push_back(trade.mass_kg);
    stiffest.y.push_back(trade.stiffest_Ns_per_m);
  }
  chart.series = {human, stiffest};
  const bool same =
      r.HasRecommendation() && SameGains(r.recommended, r.task.loop.mass_kg, r.task.loop.damping_Ns_per_m);
  if (!same)
    chart.series.push_back({.name = "the cell's own gains",
                            .x = {r.task.loop.mass_kg},
                            .y = {r.task.loop.damping_Ns_per_m},
                            .color = report::kTextColor,
                            .width_px = 0.0,
                            .marker = report::Marker::kCross});
  if (r.HasRecommendation())
    chart.series.push_back({.name = same ? "recommended, and the cell's own gains" : "recommended",
                            .x = {r.recommended.mass_kg},
                            .y = {r.recommended.damping_Ns_per_m},
                            .color = kChosenColor,
                            .width_px = 0.0,
                            .marker = report::Marker::kDiamond});
  chart.limits = {{.value = r.task.max_drag_Ns_per_m, .label = "light below"}};
  chart.x_limits = {{.value = r.task.max_mass_kg, .label = "light up to here"}};
  return report::Svg(chart);
}

}  // namespace osteon::studies
