#include "report/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "report/point_marks.h"
#include "report/svg_frame.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

/// In a plot that can zoom, curves are thinned in this many columns per pixel, so that they have enough
/// points when enlarged.
constexpr int kZoomDetail = 4;

/// The range of the finite values that were added.
struct Extent {
  double min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};
  void Add(double value) {
    if (!std::isfinite(value)) return;
    min = std::min(min, value);
    max = std::max(max, value);
  }
  [[nodiscard]] bool Any() const { return min <= max; }
};

/// Returns a range a little larger than that of the data, which must be positive.
Range LogRange(const Extent& extent) {
  constexpr double kMargin = 1.15;
  if (!extent.Any()) return {1.0, 10.0};
  return {extent.min / kMargin, extent.max * kMargin};
}

/// Returns the common x range of all panels: the range of the first panel that gives one, else the range of
/// all data.
Range CommonXRange(std::span<const LineChart> panels) {
  Extent extent;
  for (const LineChart& panel : panels) {
    if (panel.x) return *panel.x;
    for (const Series& series : panel.series)
      for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
        if (std::isfinite(series.y[i]) && (!panels.front().log_x || series.x[i] > 0.0))
          extent.Add(series.x[i]);
  }
  if (!panels.empty() && panels.front().log_x) return LogRange(extent);
  if (!extent.Any()) return {0.0, 1.0};
  if (!(extent.max > extent.min)) return NiceRange({extent.min, extent.max}, 5);
  // extend the range to the next tick mark if it is close, so that the axis of a run of 9.999 s ends at 10 s
  const Range nice = NiceRange({extent.min, extent.max}, 10);
  const double near = 0.01 * (extent.max - extent.min);
  return {extent.min - nice.min < near ? nice.min : extent.min,
          nice.max - extent.max < near ? nice.max : extent.max};
}

/// Returns the y range: the range that the panel gives, or else that of its data, extended to tick marks.
Range YRange(const LineChart& panel, int max_ticks) {
  if (panel.y) return *panel.y;
  Extent extent;
  for (const Series& series : panel.series)
    for (const double y : series.y)
      if (!panel.log_y || y > 0.0) extent.Add(y);
  if (panel.log_y) return LogRange(extent);
  // keep limit lines away from the frame
  for (const LimitLine& limit : panel.limits) extent.Add(1.05 * limit.value);
  if (panel.y_from_zero) extent.Add(0.0);
  if (!extent.Any()) return {0.0, 1.0};
  if (panel.y_from_zero && extent.min == 0.0 && extent.max == 0.0) return {0.0, 1.0};
  return NiceRange({extent.min, extent.max}, max_ticks);
}

/// Draws the line of a series; it is interrupted at points that are not finite.
std::string DrawSeries(const PlotArea& area, const Series& series, const std::string& color, bool zooms) {
  if (!(series.width_px > 0.0)) return {};
  std::string path;
  bool any = false;
  const int columns = std::max(1, static_cast<int>(area.width)) * (zooms ? kZoomDetail : 1);
  // thin the points by columns of pixels; on a logarithmic axis these are evenly spaced in log x
  std::vector<double> at = series.x;
  Range range = area.x;
  if (area.log_x) {
    for (double& x : at) x = x > 0.0 ? std::log(x) : -std::numeric_limits<double>::infinity();
    range = {std::log(range.min), std::log(range.max)};
  }
  for (auto& run : DecimateMinMax(at, series.y, range, columns)) {
    if (area.log_x)
      for (PlotPoint& point : run) point.x = std::exp(point.x);
    char command = 'M';
    for (const PlotPoint& point : run) {
      if ((area.log_x && !(point.x > 0.0)) || (area.log_y && !(point.y > 0.0))) continue;
      const double x = area.X(point.x);
      path += fmt::format("{}{} {}", command, zooms ? fmt::format("{:.2f}", x) : Pixels(x),
                          Pixels(area.Y(std::clamp(point.y, area.y.min, area.y.max))));
      command = 'L';
      any = true;
    }
    if (run.size() == 1) path += "h0.1";  // draw a single point as a dot
  }
  if (!any) return {};
  return fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round" )"
                     R"(stroke-linecap="round"{}{}{}/>)"
                     "\n",
                     path, color, Pixels(series.width_px),
                     zooms ? R"( vector-effect="non-scaling-stroke")" : "",
                     series.dash.empty() ? "" : fmt::format(R"( stroke-dasharray="{}")", series.dash),
                     series.opacity < 1.0 ? fmt::format(R"( opacity="{:.2f}")", series.opacity) : "");
}

/// Whether a point lies within the area's axes.
bool IsDrawable(const PlotArea& area, double x, double y) {
  const auto within = [](double value, Range range) { return value >= range.min && value <= range.max; };
  return within(x, area.x) && within(y, area.y) && (!area.log_x || x > 0.0) && (!area.log_y || y > 0.0);
}

/// Draws error bars and markers of all series, pale series first, then the points' names for which there is
/// room.
std::string DrawPoints(const PlotArea& area, const LineChart& panel, const std::vector<std::string>& colors) {
  constexpr std::size_t kMaxPoints = 500;  // names avoid the lines of series with at most this many points
  std::string out;
  if (std::ranges::none_of(panel.series, [](const Series& series) { return series.marker != Marker::kNone; }))
    return out;
  LabelPlacer labels(area);
  // names must not cover limits and lines
  for (const LimitLine& limit : panel.limits)
    if (limit.value > area.y.min && limit.value < area.y.max)
      labels.BlockLine(area.left, area.Y(limit.value), area.left + area.width, area.Y(limit.value));
  for (const LimitLine& limit : panel.x_limits)
    if (limit.value > area.x.min && limit.value < area.x.max)
      labels.Block(area.X(limit.value) - kFontPx - 5, area.top, kFontPx + 7, area.height);
  for (const Series& series : panel.series)
    for (std::size_t i = 1;
         series.width_px > 0.0 && i < std::min({series.x.size(), series.y.size(), kMaxPoints}); ++i)
      if (IsDrawable(area, series.x[i - 1], series.y[i - 1]) && IsDrawable(area, series.x[i], series.y[i]))
        labels.BlockLine(area.X(series.x[i - 1]), area.Y(series.y[i - 1]), area.X(series.x[i]),
                         area.Y(series.y[i]));
  std::vector<std::size_t> order(panel.series.size());  // indices of the series, pale ones first
  for (std::size_t s = 0; s < order.size(); ++s) order[s] = s;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return panel.series[a].opacity < panel.series[b].opacity;
  });
  // calls body(series, its index, the point's index, x, y in pixels) for each point that has a marker
  const auto for_each_point = [&](const auto& body) {
    for (const std::size_t s : order) {
      const Series& series = panel.series[s];
      if (series.marker == Marker::kNone) continue;
      for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i)
        if (IsDrawable(area, series.x[i], series.y[i]))
          body(series, s, i, area.X(series.x[i]), area.Y(series.y[i]));
    }
  };
  for_each_point([&](const Series& series, std::size_t s, std::size_t i, double x, double y) {
    if (i < series.y_low.size() && i < series.y_high.size()) {
      const double low = area.Y(std::clamp(series.y_low[i], area.y.min, area.y.max));
      const double high = area.Y(std::clamp(series.y_high[i], area.y.min, area.y.max));
      if (low - high > 1.0) {
        out += DrawWhisker(x, low, high, colors[s], series.opacity);
        labels.Block(x - 3, high, 6, low - high);
      }
    }
    labels.Block(x - 5, y - 5, 10, 10);
  });
  for_each_point([&](const Series& series, std::size_t s, std::size_t, double x, double y) {
    out += DrawMarker(x, y, series.marker, colors[s], series.opacity);
  });
  std::reverse(order.begin(), order.end());  // place the names of the most opaque series first
  for_each_point([&](const Series& series, std::size_t s, std::size_t i, double x, double y) {
    if (i < series.labels.size() && !series.labels[i].empty())
      out += labels.Place(x, y, series.labels[i], colors[s], series.opacity >= 1.0);
  });
  return out;
}

/// Finds where the name of a vertical line at `x` begins; the name runs upward from there. Returns the lowest
/// position at which no curve and no limit line crosses the name, or the bottom if there is none.
double FindNameStart(const PlotArea& area, const LineChart& panel, double x, double length_px) {
  std::vector<PlotPoint> taken;  // points of curves and limits near x, every few pixels
  const double left = x - kFontPx - 7.0;
  for (const LimitLine& limit : panel.limits) taken.push_back({x, area.Y(limit.value)});
  for (const Series& series : panel.series)
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
      if (!IsDrawable(area, series.x[i], series.y[i])) continue;
      const PlotPoint to{area.X(series.x[i]), area.Y(series.y[i])};
      const bool joined =
          i > 0 && series.width_px > 0.0 && IsDrawable(area, series.x[i - 1], series.y[i - 1]);
      const PlotPoint from = joined ? PlotPoint{area.X(series.x[i - 1]), area.Y(series.y[i - 1])} : to;
      const int pieces = 1 + static_cast<int>(std::hypot(to.x - from.x, to.y - from.y) / 3.0);
      for (int k = 0; k <= pieces; ++k) {
        const double t = static_cast<double>(k) / pieces;
        const PlotPoint at{std::lerp(from.x, to.x, t), std::lerp(from.y, to.y, t)};
        if (at.x > left - 4.0 && at.x < x) taken.push_back(at);
      }
    }
  const double bottom = area.top + area.height - 6.0;
  for (double y = bottom; y - length_px > area.top; y -= 4.0)
    if (std::ranges::none_of(taken,
                             [&](const PlotPoint& p) { return p.y < y + 5.0 && p.y > y - length_px - 5.0; }))
      return y;
  return bottom;
}

/// SVG of the vertical limits: the lines, and the names.
struct XLimits {
  std::string lines, names;
};

/// Draws the panel's vertical limits that are within the area.
XLimits DrawXLimits(const PlotArea& area, const LineChart& panel) {
  XLimits out;
  for (const LimitLine& limit : panel.x_limits) {
    if (!(limit.value > area.x.min && limit.value < area.x.max)) continue;
    const double x = area.X(limit.value);
    const double y = FindNameStart(area, panel, x, TextWidth(limit.label, kFontPx - 1.5));
    out.lines += SvgLine(x, area.top, x, area.top + area.height, kLimitColor, 1.4, "7 4");
    out.names += SvgTurnedText(x - 5, y, limit.label, "start", kLimitColor, kFontPx - 1.5);
  }
  return out;
}

/// Draws horizontal limit lines, with their names in the right margin, moved apart if they would overlap.
std::string DrawLimits(const PlotArea& area, std::vector<LimitLine> limits) {
  std::string out;
  std::erase_if(limits, [&area](const LimitLine& limit) {
    return !(limit.value >= area.y.min && limit.value <= area.y.max);
  });
  std::sort(limits.begin(), limits.end(), [](const auto& a, const auto& b) { return a.value > b.value; });
  double free_from = -1e9;  // lowest position that the last name occupies; the next name begins below it [px]
  for (const LimitLine& limit : limits) {
    const double y = area.Y(limit.value), right = area.left + area.width;
    out += SvgLine(area.left, y, right, y, kLimitColor, 1.4, "7 4");
    const double baseline = std::max(y + 4.3, free_from);
    out += SvgText(right + 6, baseline, limit.label, "start", kLimitColor);
    free_from = baseline + kFontPx + 2.0;
  }
  return out;
}

/// The layout of a panel, computed before anything is drawn.
struct PanelPlan {
  PlotArea area;
  Ticks y_ticks;
  std::vector<LegendEntry> legend;
  std::vector<std::string> colors;
  bool strip{false};  ///< the panel has a strip for span names, because at least one span is wide enough for
                      ///< its name
  bool data{false};   ///< at least one series has a finite point
};

// A panel that the page's script (scripts/plot_cursor.js) can zoom is <g class="panel"> with the pixels of
// its area and the values at its edges. Its curves are in a separate <svg class="data">, which clips them. To
// zoom, the script changes the viewBox of this <svg>, makes new lines of .x-grid and new texts of .x-texts,
// and hides .x-names.

/// Opens the <g class="panel">.
std::string BeginZoomPanel(const PlotArea& area) {
  return fmt::format(
      "<g class=\"panel\" data-area=\"{:.2f} {:.2f} {:.2f} {:.2f}\" data-x=\"{:.9g} {:.9g}\" "
      "data-y=\"{:.9g} {:.9g}\">\n",
      area.left, area.top, area.width, area.height, area.x.min, area.x.max, area.y.min, area.y.max);
}

/// Opens the <svg class="data"> over the area.
std::string BeginZoomData(const PlotArea& area) {
  return fmt::format(
      "<svg class=\"data\" x=\"{0:.2f}\" y=\"{1:.2f}\" width=\"{2:.2f}\" height=\"{3:.2f}\" "
      "viewBox=\"{0:.2f} {1:.2f} {2:.2f} {3:.2f}\" preserveAspectRatio=\"none\">\n",
      area.left, area.top, area.width, area.height);
}

/// Draws panels one above the other. @returns the elements, without the <svg> around them, and their height.
LegendBlock DrawPanels(std::span<const LineChart> panels, double width_px) {
  const Range x = CommonXRange(panels);
  std::vector<PanelPlan> plans;
  double left = 0.0, right = 16.0, label_lines = 1.0;

  // axis ranges, and margins that are wide enough for every panel
  for (const LineChart& panel : panels) {
    PanelPlan plan;
    const int max_ticks = std::max(2, static_cast<int>(panel.plot_height_px / 34.0));
    plan.area = {.height = panel.plot_height_px,
                 .x = x,
                 .y = YRange(panel, max_ticks),
                 .log_x = panels.front().log_x,
                 .log_y = panel.log_y};
    plan.y_ticks =
        panel.log_y ? LogTicks(plan.area.y, max_ticks + 1) : LinearTicks(plan.area.y, max_ticks + 1);
    left = std::max(left, WidestLabel(plan.y_ticks));
    label_lines = std::max(label_lines,
                           static_cast<double>(AxisLabelLines(panel.y_label, panel.plot_height_px).size()));
    for (const LimitLine& limit : panel.limits)
      right = std::max(right, TextWidth(limit.label, kFontPx) + 12.0);
    plans.push_back(std::move(plan));
  }
  const double y_label_x = 14.0 + kLabelLinePx * (label_lines - 1.0);
  left += y_label_x + kLabelStripPx;
  right = std::min(right, width_px / 3);
  Ticks x_ticks = !panels.empty() && panels.front().log_x ? LogTicks(x, 10) : LinearTicks(x, 10);
  if (!x_ticks.labels.empty()) right = std::max(right, TextWidth(x_ticks.labels.back(), kFontPx) / 2 + 4.0);

  const bool zooms = !panels.empty() && panels.front().zooms;
  std::string body;
  double cursor = 2.0;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const LineChart& panel = panels[p];
    PanelPlan& plan = plans[p];
    plan.area.left = left;
    plan.area.width = width_px - left - right;

    // legend: series, then spans too narrow for their name
    for (std::size_t s = 0; s < panel.series.size(); ++s) {
      const Series& series = panel.series[s];
      plan.colors.push_back(series.color.empty() ? kPalette[s % kPalette.size()] : series.color);
      if (!series.name.empty() && panel.legend)
        plan.legend.push_back({.text = series.name,
                               .color = plan.colors.back(),
                               .mark = !(series.width_px > 0.0) ? LegendEntry::Mark::kNone
                                       : series.dash.empty()    ? LegendEntry::Mark::kLine
                                                                : LegendEntry::Mark::kDash,
                               .marker = series.marker});
      plan.data |= std::any_of(series.y.begin(), series.y.end(), [](double y) { return std::isfinite(y); });
    }
    std::vector<std::string> named;  // names of spans that are already in the legend
    for (const NamedSpan& span : panel.spans) {
      const double pixels = plan.area.X(std::min(span.end, x.max)) - plan.area.X(std::max(span.begin, x.min));
      if (TextWidth(span.name, kFontPx) + 8.0 <= pixels) {
        plan.strip = true;
      } else if (pixels > 0.0 && std::find(named.begin(), named.end(), span.name) == named.end()) {
        plan.legend.push_back({.text = span.name, .color = span.color, .mark = LegendEntry::Mark::kFill});
        named.push_back(span.name);
      }
    }
    const LegendBlock legend =
        DrawLegend(left, cursor, plan.area.width + right - 4.0, panel.title, plan.legend);
    body += legend.svg;
    plan.area.top = cursor + legend.height_px + (plan.strip ? kLabelStripPx : 6.0);

    // spans, grid, data, limits, texts
    std::string spans, span_names;
    for (const NamedSpan& span : panel.spans) {
      const double begin = plan.area.X(std::max(span.begin, x.min)),
                   end = plan.area.X(std::min(span.end, x.max));
      if (!(end > begin)) continue;
      spans +=
          SvgRect(begin, plan.area.top, end - begin, plan.area.height, span.color, R"(fill-opacity="0.65")");
      if (TextWidth(span.name, kFontPx) + 8.0 <= end - begin)
        span_names += SvgText((begin + end) / 2, plan.area.top - 5, span.name, "middle", kMutedColor);
    }
    std::string curves;
    for (std::size_t s = 0; s < panel.series.size(); ++s)
      curves += DrawSeries(plan.area, panel.series[s], plan.colors[s], zooms);
    const XLimits x_limits = DrawXLimits(plan.area, panel);
    const bool last = p + 1 == panels.size();
    Ticks shown = x_ticks;
    if (!last) std::fill(shown.labels.begin(), shown.labels.end(), std::string());
    SpreadLabels(plan.area, shown);
    if (zooms) {
      body += BeginZoomPanel(plan.area);
      body += "<g class=\"x-grid\">" + DrawGrid(plan.area, x_ticks, {}) + "</g>\n";
      body += DrawGrid(plan.area, {}, plan.y_ticks);
      body += BeginZoomData(plan.area) + spans + curves + x_limits.lines + "</svg>\n";
      body += "<g class=\"x-names\">" + span_names + x_limits.names + "</g>\n";
      body += "<g class=\"x-texts\">" + DrawTickTexts(plan.area, shown, {}) + "</g>\n";
      body += DrawTickTexts(plan.area, {}, plan.y_ticks) + DrawLimits(plan.area, panel.limits) + "</g>\n";
    } else {
      body += spans + span_names + DrawGrid(plan.area, x_ticks, plan.y_ticks) + curves;
      body += DrawLimits(plan.area, panel.limits) + x_limits.lines + x_limits.names;
      body += DrawPoints(plan.area, panel, plan.colors);
      body += DrawTickTexts(plan.area, shown, plan.y_ticks);
    }
    if (!plan.data)
      body += SvgText(left + plan.area.width / 2, plan.area.top + plan.area.height / 2, "no data", "middle",
                      kMutedColor);
    const double bottom = plan.area.top + plan.area.height;
    body += DrawAxisLabels(plan.area, last ? panel.x_label : "", bottom + 38, panel.y_label, y_label_x);
    cursor = bottom + (last ? 46.0 : 16.0);
  }
  return {.svg = body, .height_px = cursor};
}

}  // namespace

std::string Svg(std::span<const LineChart> panels, double width_px) {
  const LegendBlock drawn = DrawPanels(panels, width_px);
  return SvgDocument(width_px, drawn.height_px, panels.empty() ? "" : panels.front().title, drawn.svg);
}

std::string SvgGrid(std::span<const LineChart> panels, int columns, const std::string& title,
                    const std::vector<LegendEntry>& legend, double width_px) {
  constexpr double kGap = 14.0, kMargin = 10.0;
  const auto count = static_cast<double>(std::max(1, columns));
  const double width = (width_px - 2.0 * kMargin - (count - 1.0) * kGap) / count;
  const LegendBlock heading = DrawLegend(kMargin + 4.0, 4.0, width_px - 2.0 * kMargin, title, {});
  const LegendBlock names =
      DrawLegend(kMargin + 4.0, 4.0 + heading.height_px, width_px - 2.0 * kMargin, "", legend);
  std::string body = heading.svg + names.svg;
  double top = 10.0 + heading.height_px + names.height_px, row_height = 0.0;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const auto column = static_cast<double>(p % static_cast<std::size_t>(std::max(1, columns)));
    if (column == 0.0 && p > 0) {
      top += row_height + kGap;
      row_height = 0.0;
    }
    const LegendBlock drawn = DrawPanels(panels.subspan(p, 1), width);
    row_height = std::max(row_height, drawn.height_px);
    body += fmt::format("<g transform=\"translate({} {})\">\n{}</g>\n",
                        Pixels(kMargin + column * (width + kGap)), Pixels(top), drawn.svg);
  }
  return SvgDocument(width_px, top + row_height + 4.0, title, body);
}

}  // namespace osteon::report
