#include "report/svg_frame.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "report/point_marks.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

/// Returns the position of a value in a range, 0 at min and 1 at max. On a logarithmic axis, values below a
/// thousandth of min, including 0 and negative values, are treated as a thousandth of min.
double Share(double value, Range range, bool log) {
  if (log) {
    const double floor_value = std::max(value, range.min * 1e-3);
    return std::log(floor_value / range.min) / std::log(range.max / range.min);
  }
  return (value - range.min) / (range.max - range.min);
}

}  // namespace

std::string SvgText(double x, double y, std::string_view text, std::string_view anchor,
                    std::string_view color, double size_px, std::string_view extra) {
  return fmt::format(R"(<text x="{}" y="{}" text-anchor="{}" fill="{}" font-size="{}"{}{}>{}</text>)"
                     "\n",
                     Pixels(x), Pixels(y), anchor, color, Pixels(size_px), extra.empty() ? "" : " ", extra,
                     Escape(text));
}

std::string SvgTurnedText(double x, double y, std::string_view text, std::string_view anchor,
                          std::string_view color, double size_px) {
  return SvgText(x, y, text, anchor, color, size_px,
                 fmt::format(R"x(transform="rotate(-90 {} {})")x", Pixels(x), Pixels(y)));
}

std::string SvgLine(double x1, double y1, double x2, double y2, std::string_view color, double width_px,
                    std::string_view dash) {
  return fmt::format(R"(<line x1="{}" y1="{}" x2="{}" y2="{}" stroke="{}" stroke-width="{}"{}/>)"
                     "\n",
                     Pixels(x1), Pixels(y1), Pixels(x2), Pixels(y2), color, Pixels(width_px),
                     dash.empty() ? std::string() : fmt::format(R"( stroke-dasharray="{}")", dash));
}

std::string SvgRect(double x, double y, double width, double height, std::string_view fill,
                    std::string_view extra) {
  return fmt::format(R"(<rect x="{}" y="{}" width="{}" height="{}" fill="{}"{}{}/>)"
                     "\n",
                     Pixels(x), Pixels(y), Pixels(std::max(width, 0.0)), Pixels(std::max(height, 0.0)), fill,
                     extra.empty() ? "" : " ", extra);
}

std::string SvgDocument(double width, double height, std::string_view title, std::string_view body) {
  return fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0}" height="{1}" viewBox="0 0 {0} {1}" role="img" )"
      R"(aria-label="{2}" font-family="{3}">)"
      "\n{4}{5}</svg>\n",
      Pixels(std::ceil(width)), Pixels(std::ceil(height)), Escape(title), kFontFamily,
      SvgRect(0, 0, std::ceil(width), std::ceil(height), "#ffffff"), body);
}

double PlotArea::X(double value) const { return left + width * Share(value, x, log_x); }
double PlotArea::Y(double value) const { return top + height * (1.0 - Share(value, y, log_y)); }

std::string DrawGrid(const PlotArea& area, const Ticks& x, const Ticks& y) {
  std::string out;
  const double right = area.left + area.width, bottom = area.top + area.height;
  for (const double value : x.at) out += SvgLine(area.X(value), area.top, area.X(value), bottom, kGridColor);
  for (const double value : y.at) out += SvgLine(area.left, area.Y(value), right, area.Y(value), kGridColor);
  out += SvgLine(area.left, area.top, area.left, bottom, kAxisColor);
  out += SvgLine(area.left, bottom, right, bottom, kAxisColor);
  return out;
}

std::string DrawTickTexts(const PlotArea& area, const Ticks& x, const Ticks& y) {
  std::string out;
  const double bottom = area.top + area.height;
  for (std::size_t i = 0; i < x.at.size(); ++i) {
    out +=
        SvgLine(area.X(x.at[i]), bottom, area.X(x.at[i]), bottom + (x.labels[i].empty() ? 3 : 5), kAxisColor);
    if (!x.labels[i].empty()) out += SvgText(area.X(x.at[i]), bottom + 18, x.labels[i], "middle");
  }
  for (std::size_t i = 0; i < y.at.size(); ++i) {
    out += SvgLine(area.left - (y.labels[i].empty() ? 3 : 5), area.Y(y.at[i]), area.left, area.Y(y.at[i]),
                   kAxisColor);
    if (!y.labels[i].empty()) out += SvgText(area.left - 9, area.Y(y.at[i]) + 4.3, y.labels[i], "end");
  }
  return out;
}

std::string DrawAxisLabels(const PlotArea& area, std::string_view x_label, double x_label_y,
                           std::string_view y_label, double y_label_x) {
  std::string out;
  if (!x_label.empty())
    out +=
        SvgText(area.left + area.width / 2, x_label_y, Fit(x_label, area.width + 40), "middle", kTextColor);
  if (!y_label.empty()) {
    const double y = area.top + area.height / 2;
    const std::vector<std::string> lines = AxisLabelLines(y_label, area.height);
    double x = y_label_x - kLabelLinePx * (static_cast<double>(lines.size()) - 1.0);
    for (const std::string& line : lines) {
      out += SvgTurnedText(x, y, line, "middle", kTextColor);
      x += kLabelLinePx;
    }
  }
  return out;
}

std::vector<std::string> AxisLabelLines(std::string_view y_label, double height_px) {
  return Wrap(y_label, height_px + 24.0);
}

double WidestLabel(const Ticks& ticks) {
  double widest = 0.0;
  for (const std::string& label : ticks.labels) widest = std::max(widest, TextWidth(label, kFontPx));
  return widest;
}

void SpreadLabels(const PlotArea& area, Ticks& x) {
  double free_from = -1e9;  // x at the end of the last label that was kept [px]
  for (std::size_t i = 0; i < x.at.size(); ++i) {
    if (x.labels[i].empty()) continue;
    const double half = TextWidth(x.labels[i], kFontPx) / 2;
    if (area.X(x.at[i]) - half < free_from) {
      x.labels[i].clear();
    } else {
      free_from = area.X(x.at[i]) + half + 0.6 * kFontPx;
    }
  }
}

LegendBlock DrawLegend(double x, double y, double width_px, std::string_view title,
                       const std::vector<LegendEntry>& entries) {
  constexpr double kMark = 20.0, kGap = 18.0;
  LegendBlock block;
  double cursor = x, baseline = y + 15.0;
  if (!title.empty()) {
    // the width estimate is for regular text; bold text is about a tenth wider
    const std::vector<std::string> lines = Wrap(title, width_px / 1.1, kTitlePx);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i > 0) baseline += kLegendRowPx;
      block.svg += SvgText(x, baseline, lines[i], "start", kTextColor, kTitlePx, R"(font-weight="600")");
    }
    cursor += 1.1 * TextWidth(lines.back(), kTitlePx) + 1.5 * kGap;
  }
  for (const LegendEntry& entry : entries) {
    const std::string text = Fit(entry.text, width_px - kMark);
    const double needed = kMark + TextWidth(text, kFontPx);
    if (cursor > x && cursor + needed > x + width_px) {
      cursor = x;
      baseline += kLegendRowPx;
    }
    if (entry.mark == LegendEntry::Mark::kFill) {
      block.svg +=
          SvgRect(cursor, baseline - 9.5, 13, 10, entry.color, R"(stroke="#8a939c" stroke-width="0.6")");
    } else if (entry.mark != LegendEntry::Mark::kNone) {
      block.svg += SvgLine(cursor, baseline - 4.3, cursor + 15, baseline - 4.3, entry.color, 2.4,
                           entry.mark == LegendEntry::Mark::kDash ? "5 3" : "");
    }
    block.svg += DrawMarker(cursor + 7.5, baseline - 4.3, entry.marker, entry.color);
    block.svg += SvgText(cursor + kMark, baseline, text);
    cursor += needed + kGap;
  }
  block.height_px = title.empty() && entries.empty() ? 0.0 : baseline - y + 8.0;
  return block;
}

std::vector<std::string> Wrap(std::string_view text, double width_px, double size_px) {
  std::vector<std::string> lines(1);
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(text.size(), word.size() + 1));
    std::string& line = lines.back();
    const std::string longer = line.empty() ? std::string(word) : line + " " + std::string(word);
    if (line.empty() || TextWidth(longer, size_px) <= width_px)
      line = longer;
    else
      lines.emplace_back(word);
  }
  for (std::string& line : lines) line = Fit(line, width_px, size_px);
  return lines;
}

std::string Fit(std::string_view text, double width_px, double size_px) {
  if (TextWidth(text, size_px) <= width_px) return std::string(text);
  std::string cut(text);
  while (!cut.empty() && TextWidth(cut, size_px) + size_px > width_px) {
    // remove whole characters: all tail bytes of a UTF-8 sequence together with its first byte
    while (!cut.empty() && base::IsTailByte(cut.back())) cut.pop_back();
    if (!cut.empty()) cut.pop_back();
  }
  return cut + "\xE2\x80\xA6";
}

}  // namespace osteon::report
