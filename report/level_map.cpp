#include "report/level_map.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/heat_map.h"
#include "report/point_marks.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

constexpr const char* kNothing = "#dfe2e6";  // colour of cells without a value
// Widths [px]: colour scale's bar, gap between panels, strip beside each panel for its y axis.
constexpr double kScaleWidth = 16.0, kGap = 12.0, kAxisStrip = 100.0;

// Draws each cell in the colour of its band.
std::string DrawCells(const LevelMap& map, const LevelScale& scale, const PlotArea& area) {
  std::string out = SvgRect(area.left, area.top, area.width, area.height, kNothing);
  const double width = area.width / map.nx, height = area.height / map.ny;
  for (int j = 0; j < map.ny; ++j)
    for (int i = 0; i < map.nx; ++i) {
      const double value = map.values[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.nx) +
                                      static_cast<std::size_t>(i)];
      if (!(value >= scale.min)) continue;
      const double bands = (value - scale.min) / (scale.max - scale.min) * scale.bands;
      const int band = std::min(scale.bands - 1, static_cast<int>(bands));
      // draw a little more than the cell, so that no seams show between neighbours
      out += SvgRect(area.left + i * width, area.top + area.height - (j + 1) * height, width + 0.4,
                     height + 0.4, BandColor(band, scale.bands));
    }
  return out;
}

bool Inside(const LevelMap& map, double x, double y) {
  return x >= map.x.min && x <= map.x.max && y >= map.y.min && y <= map.y.max;  // false for NaN
}

// Draws the curves' lines and, above them, their markers.
std::string DrawCurves(const LevelMap& map, const PlotArea& area) {
  std::string lines, marks;
  for (const Series& curve : map.curves) {
    const std::string color = curve.color.empty() ? kTextColor : curve.color;
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      if (!Inside(map, curve.x[i], curve.y[i])) continue;
      if (i > 0 && curve.width_px > 0.0 && Inside(map, curve.x[i - 1], curve.y[i - 1]))
        lines += SvgLine(area.X(curve.x[i - 1]), area.Y(curve.y[i - 1]), area.X(curve.x[i]),
                         area.Y(curve.y[i]), color, curve.width_px);
      marks += DrawMarker(area.X(curve.x[i]), area.Y(curve.y[i]), curve.marker, color);
    }
  }
  return lines + marks;
}

// Draws the colour scale with its ticks and label, to the right of (left, top) [px].
std::string ScaleBar(const LevelScale& scale, double left, double top, double height) {
  std::string out;
  out += ViridisBands(left, top, kScaleWidth, height, scale.bands) +
         SvgRect(left, top, kScaleWidth, height, "none", fmt::format(R"(stroke="{}")", kAxisColor));
  for (int b = 0; b <= scale.bands; b += 2) {
    const double y = top + height * (1.0 - static_cast<double>(b) / scale.bands);
    const double value = scale.min + (scale.max - scale.min) * b / scale.bands;
    out += SvgText(left + kScaleWidth + 7, y + 4.3,
                   (b == scale.bands ? "\xE2\x89\xA5 " : "") + Number(value, 0));
  }
  const double x = left + kScaleWidth + 56, y = top + 0.5 * height;
  return out + SvgTurnedText(x, y, Fit(scale.label, height), "middle", kTextColor);
}

}  // namespace

std::string LevelMapSvg(const std::vector<LevelMap>& panels, const LevelScale& scale,
                        const std::string& title, const std::vector<LegendEntry>& legend, double width_px) {
  constexpr double kScaleStrip = kScaleWidth + 84.0, kLeft = 4.0;
  const LegendBlock block = DrawLegend(kLeft, 2.0, width_px - 8.0, title, legend);
  const auto count = static_cast<double>(panels.size());
  const double panel_width = (width_px - kScaleStrip - kLeft - kGap * (count - 1.0)) / count;
  const double top = block.height_px + 34.0;
  std::string body = block.svg;
  PlotArea area;
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const LevelMap& map = panels[k];
    area = {.x = map.x, .y = map.y, .log_x = true, .log_y = true};
    area.left = kLeft + static_cast<double>(k) * (panel_width + kGap) + kAxisStrip;
    area.top = top;
    area.width = panel_width - kAxisStrip;
    area.height = area.width;
    Ticks x = LogTicks(map.x, 12);
    const Ticks y = LogTicks(map.y, 12);
    SpreadLabels(area, x);
    body += SvgText(area.left, area.top - 9.0, Fit(map.title, area.width), "start", kTextColor, kFontPx,
                    R"(font-weight="600")");
    body += DrawCells(map, scale, area) + DrawCurves(map, area);
    body += SvgRect(area.left, area.top, area.width, area.height, "none",
                    fmt::format(R"(stroke="{}")", kAxisColor));
    body += DrawTickTexts(area, x, y) + DrawAxisLabels(area, map.x_label, area.top + area.height + 38.0,
                                                       map.y_label, area.left - WidestLabel(y) - 20.0);
  }
  body += ScaleBar(scale, width_px - kScaleStrip + 14.0, top, area.height);
  return SvgDocument(width_px, top + area.height + 48.0, title, body);
}

}  // namespace osteon::report
