#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "report/svg_frame.h"
#include "report/svg_plot.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

/// A value of a histogram and how often it occurred.
struct CountedValue {
  double value;
  std::uint64_t times;
};

/// The finite values with their counts, ascending.
std::vector<CountedValue> SortedCounts(const Histogram& histogram) {
  std::vector<CountedValue> counted;
  for (std::size_t i = 0; i < histogram.values.size(); ++i)
    if (std::isfinite(histogram.values[i]))
      counted.push_back({histogram.values[i], histogram.times.empty() ? 1 : histogram.times[i]});
  std::sort(counted.begin(), counted.end(),
            [](const CountedValue& a, const CountedValue& b) { return a.value < b.value; });
  return counted;
}

/// Returns the p quantile by the same rule as base::Percentile. `values` must not be empty.
double PercentileOf(const std::vector<CountedValue>& values, double p) {
  std::uint64_t total = 0, before = 0;
  for (const CountedValue& each : values) total += each.times;
  const double rank = std::max(1.0, std::ceil(p * static_cast<double>(total)));
  for (const CountedValue& each : values) {
    before += each.times;
    if (static_cast<double>(before) >= rank) return each.value;
  }
  return values.back().value;
}

}  // namespace

std::string Svg(const Histogram& histogram, double width_px) {
  const std::vector<CountedValue> values = SortedCounts(histogram);
  const auto first = std::ranges::find_if(
      values, [&](const CountedValue& each) { return !histogram.log_x || each.value > 0.0; });
  const bool any = first != values.end(), log_x = histogram.log_x && any;

  // bins
  PlotArea area{.height = histogram.plot_height_px, .log_x = log_x, .log_y = histogram.log_y};
  area.x = any ? Range{first->value, values.back().value} : Range{0.0, 1.0};
  if (log_x) {
    area.x = {area.x.min * 0.9, area.x.max * 1.1};
  } else {
    area.x = NiceRange(area.x, 6);
  }
  const int bins = std::max(1, histogram.bins);
  std::vector<std::uint64_t> counts(static_cast<std::size_t>(bins), 0);
  // maps a value to its bin: a plot area whose width is one pixel per bin
  const PlotArea bin_axis{.width = static_cast<double>(bins), .x = area.x, .log_x = log_x};
  for (const auto& [value, times] : values) {
    const double at = log_x && !(value > 0.0) ? 0.0 : bin_axis.X(value);
    counts[static_cast<std::size_t>(std::clamp(static_cast<int>(at), 0, bins - 1))] += times;
  }
  const double highest =
      static_cast<double>(std::max<std::uint64_t>(1, *std::max_element(counts.begin(), counts.end())));
  area.y = histogram.log_y ? Range{0.7, std::max(highest * 1.4, 10.0)} : NiceRange({0.0, highest}, 5);
  const Ticks y_ticks = histogram.log_y ? LogTicks(area.y, 8) : LinearTicks(area.y, 6);

  // legend with the percentiles
  struct PercentileLine {
    double at;
    const char* color;
  };
  std::vector<LegendEntry> legend;
  std::vector<PercentileLine> markers;
  if (histogram.percentiles && !values.empty()) {
    const auto add = [&](const char* name, double p, const char* color) {
      const double at = PercentileOf(values, p);
      legend.push_back({.text = fmt::format("{} {} {}", name, Number(at), histogram.unit),
                        .color = color,
                        .mark = LegendEntry::Mark::kDash});
      markers.push_back({at, color});
    };
    add("median", 0.5, kPalette[2]);
    add("99 %", 0.99, kPalette[4]);
    add("99.9 %", 0.999, kPalette[1]);
    add("max", 1.0, kLimitColor);
  }
  area.left = WidestLabel(y_ticks) + 14.0 + kLabelStripPx;
  area.width = width_px - area.left - 22.0;
  const LegendBlock title = DrawLegend(area.left, 2.0, area.width + 18.0, histogram.title, {});
  const LegendBlock block = DrawLegend(area.left, 2.0 + title.height_px, area.width + 18.0, "", legend);
  area.top = 2.0 + title.height_px + block.height_px + 6.0;
  Ticks x_ticks = log_x ? LogTicks(area.x, 9) : LinearTicks(area.x, 6);
  SpreadLabels(area, x_ticks);

  std::string body = title.svg + block.svg + DrawGrid(area, x_ticks, y_ticks);
  const double base = area.top + area.height;
  for (int i = 0; i < bins; ++i) {
    const auto count = static_cast<double>(counts[static_cast<std::size_t>(i)]);
    if (count == 0.0) continue;
    const double x0 = area.left + area.width * i / bins, x1 = area.left + area.width * (i + 1) / bins;
    const double top = area.Y(count);
    body += SvgRect(x0 + 0.4, top, x1 - x0 - 0.8, base - top, kPalette[0]);
  }
  for (const PercentileLine& marker : markers)
    if (!log_x || marker.at > 0.0)
      body += SvgLine(area.X(marker.at), area.top, area.X(marker.at), base, marker.color, 1.5, "5 3");
  if (values.empty())
    body += SvgText(area.left + area.width / 2, area.top + area.height / 2, "no data", "middle", kMutedColor);
  body += DrawTickTexts(area, x_ticks, y_ticks);
  body += DrawAxisLabels(area, histogram.x_label, base + 38, histogram.y_label, 14.0);
  return SvgDocument(width_px, base + 46.0, histogram.title, body);
}

}  // namespace osteon::report
