#include "studies/validate/validate_plot.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "report/point_marks.h"
#include "report/svg_frame.h"
#include "report/svg_text.h"

namespace osteon::studies {
namespace {

// Width of the picture, height of a row, margin around the plot, and height of the axis below the rows.
constexpr double kWidth_px = 920.0, kRow_px = 22.0, kMargin_px = 14.0, kAxis_px = 44.0;
constexpr double kMin = 0.1, kMax = 10.0;  // ends of the axis of the ratio simulated / measured
constexpr std::array kTicks{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};
constexpr const char* kSpreadColor = "#c9d3dd";

// Colour and marker of a verdict.
struct VerdictStyle {
  const char* color;
  report::Marker marker;
};

VerdictStyle StyleOf(std::string_view verdict) {
  if (verdict == "within") return {report::kPalette[2], report::Marker::kCircle};
  if (verdict == "misses") return {report::kPalette[1], report::Marker::kDiamond};
  return {report::kMutedColor, report::Marker::kRing};
}

// Position of a ratio on the axis [px]; a ratio beyond the axis is put at its end.
double AxisPosition_px(double ratio, double left, double width) {
  const double share = std::log(std::clamp(ratio, kMin, kMax) / kMin) / std::log(kMax / kMin);
  return left + share * width;
}

// Draws a row at height y: id, measured spread, marker and simulated value.
std::string DrawRow(const ValidationRow& row, double y, double left, double width) {
  const Measurement& m = *row.measurement;
  std::string svg = report::SvgText(kMargin_px, y + 4.0, m.id);
  svg += report::SvgLine(left, y, left + width, y, report::kGridColor);
  if (m.judged()) {
    const double from = AxisPosition_px(m.low / m.measured, left, width),
                 to = AxisPosition_px(m.high / m.measured, left, width);
    svg += report::SvgRect(from, y - 5.0, std::max(2.0, to - from), 10.0, kSpreadColor);
  }
  if (!row.error.empty()) return svg;
  const double ratio = row.simulated.value / m.measured;
  const VerdictStyle style = StyleOf(row.verdict());
  const double x = AxisPosition_px(ratio, left, width);
  svg += report::DrawMarker(x, y, style.marker, style.color);
  const std::string text =
      report::Number(row.simulated.value) + (m.unit == "1" ? std::string() : " " + std::string(m.unit));
  return svg + report::SvgText(left + width + 10.0, y + 4.0, text, "start", style.color);
}

}  // namespace

std::string ValidationPlot(std::span<const ValidationRow> rows) {
  double names_px = 0.0;
  for (const ValidationRow& row : rows)
    names_px = std::max(names_px, report::TextWidth(row.measurement->id, report::kFontPx));
  const double left = kMargin_px + names_px + 12.0, width = kWidth_px - left - 110.0;
  const report::LegendBlock legend = report::DrawLegend(
      kMargin_px, kMargin_px, kWidth_px - 2.0 * kMargin_px, "Simulated over measured",
      {{.text = "measured spread", .color = kSpreadColor, .mark = report::LegendEntry::Mark::kFill},
       {.text = "within",
        .color = report::kPalette[2],
        .mark = report::LegendEntry::Mark::kNone,
        .marker = report::Marker::kCircle},
       {.text = "misses",
        .color = report::kPalette[1],
        .mark = report::LegendEntry::Mark::kNone,
        .marker = report::Marker::kDiamond},
       {.text = "calibrates, or not judged",
        .color = report::kMutedColor,
        .mark = report::LegendEntry::Mark::kNone,
        .marker = report::Marker::kRing}});
  const double top = kMargin_px + legend.height_px + 10.0;
  const double height = kRow_px * static_cast<double>(rows.size());
  std::string body = legend.svg;
  for (const double tick : kTicks) {
    const double x = AxisPosition_px(tick, left, width);
    body += report::SvgLine(x, top, x, top + height, tick == 1.0 ? report::kAxisColor : report::kGridColor,
                            tick == 1.0 ? 1.5 : 1.0);
    const std::string text = tick == kMin   ? fmt::format("≤ {:g}", tick)
                             : tick == kMax ? fmt::format("≥ {:g}", tick)
                                            : fmt::format("{:g}", tick);
    body += report::SvgText(x, top + height + 17.0, text, "middle", report::kMutedColor);
  }
  double y = top + 0.5 * kRow_px;
  for (const ValidationRow& row : rows) {
    body += DrawRow(row, y, left, width);
    y += kRow_px;
  }
  body += report::SvgText(left + 0.5 * width, top + height + 36.0, "simulated over measured [1]", "middle");
  return report::SvgDocument(kWidth_px, top + height + kAxis_px, "Simulated over measured, row by row", body);
}

}  // namespace osteon::studies
