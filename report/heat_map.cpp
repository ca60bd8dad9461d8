#include "report/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>

#include <fmt/format.h>

#include "report/png_file.h"
#include "report/point_marks.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

// Evenly spaced colours of viridis, RGB 0 … 255.
constexpr std::array<std::array<double, 3>, 9> kViridis{{{68, 1, 84},
                                                         {71, 45, 123},
                                                         {59, 82, 139},
                                                         {44, 114, 142},
                                                         {33, 145, 140},
                                                         {40, 174, 128},
                                                         {94, 201, 98},
                                                         {173, 220, 48},
                                                         {253, 231, 37}}};
constexpr std::array<std::uint8_t, 3> kEmptyRgb{228, 230, 233};  // where there is no value
constexpr int kPixelsACell = 8;       // pixels of the picture along each edge of a cell between four nodes
constexpr double kLabelPx = 11.5;     // font size of contour numbers and marks' labels
constexpr double kGap = 30.0;         // between panels [px]
constexpr double kScaleWidth = 18.0;  // width of the colour scale's bar [px]

// RGB 0 … 255 of a fraction 0 … 1 of the colour scale.
std::array<double, 3> Viridis(double share) {
  const double at = std::clamp(share, 0.0, 1.0) * (kViridis.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), kViridis.size() - 2);
  std::array<double, 3> rgb{};
  for (std::size_t i = 0; i < 3; ++i)
    rgb[i] = std::lerp(kViridis[low][i], kViridis[low + 1][i], at - static_cast<double>(low));
  return rgb;
}

// Returns the position of a value's band on the colour scale, 0 … 1. All values of a band get the same
// colour, so that a reader can match map and scale.
double BandShare(const HeatScale& scale, double value) {
  const double bands = std::round((scale.max - scale.min) / scale.step);
  const double band = std::clamp(std::floor((value - scale.min) / scale.step), 0.0, bands - 1.0);
  return bands > 1.0 ? band / (bands - 1.0) : 0.0;
}

// The value of node (i, j).
double At(const HeatMap& map, int i, int j) {
  return map
      .values[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.nx) + static_cast<std::size_t>(i)];
}

// Interpolates linearly between the nodes that have a value; NaN if the nearest node has none.
// @param u, v  position in units of nodes, from node (0, 0)
double Interpolate(const HeatMap& map, double u, double v) {
  const int i = std::min(static_cast<int>(u), map.nx - 2), j = std::min(static_cast<int>(v), map.ny - 2);
  const double s = u - i, t = v - j;
  if (!std::isfinite(At(map, s < 0.5 ? i : i + 1, t < 0.5 ? j : j + 1))) return std::nan("");
  double weighted_sum = 0.0, weights = 0.0;
  for (const int di : {0, 1})
    for (const int dj : {0, 1}) {
      const double value = At(map, i + di, j + dj), weight = (di ? s : 1.0 - s) * (dj ? t : 1.0 - t);
      if (!std::isfinite(value)) continue;
      weighted_sum += weight * value;
      weights += weight;
    }
  return weighted_sum / weights;
}

// Draws the field's bands of colour as an embedded picture; empty text if it cannot be encoded.
std::string DrawField(const HeatMap& map, const HeatScale& scale, const PlotArea& area) {
  Image image{.width = kPixelsACell * (map.nx - 1), .height = kPixelsACell * (map.ny - 1)};
  image.rgb.reserve(3u * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const double value =
          Interpolate(map, (column + 0.5) / kPixelsACell, map.ny - 1 - (row + 0.5) / kPixelsACell);
      if (!std::isfinite(value)) {
        image.rgb.insert(image.rgb.end(), kEmptyRgb.begin(), kEmptyRgb.end());
        continue;
      }
      for (const double channel : Viridis(BandShare(scale, value)))
        image.rgb.push_back(static_cast<std::uint8_t>(std::lround(channel)));
    }
  const auto png = EncodePng(image);
  if (!png) return {};
  return fmt::format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
      "href=\"data:image/png;base64,{}\"/>\n",
      Pixels(area.left), Pixels(area.top), Pixels(area.width), Pixels(area.height), Base64(*png));
}

// Returns the values minus `level`, so that the zero lines are the contours of `level`. A node without a
// value gets the mean of its neighbours, ring by ring, so that the lines reach the edge of the region that
// has values.
PlanarGrid AboveLevel(const HeatMap& map, double level) {
  PlanarGrid grid({0.0, 0.0}, {0.0, 0.0}, 1.0, 0.0F);
  grid.nx = map.nx;
  grid.ny = map.ny;
  std::vector<double> values = map.values;
  for (bool has_gaps = true; has_gaps;) {
    has_gaps = false;
    const std::vector<double> before = values;
    bool filled_any = false;
    for (int j = 0; j < map.ny; ++j)
      for (int i = 0; i < map.nx; ++i) {
        const auto at = [&](int x, int y) {
          return static_cast<std::size_t>(y) * static_cast<std::size_t>(map.nx) + static_cast<std::size_t>(x);
        };
        if (std::isfinite(before[at(i, j)])) continue;
        double sum = 0.0;
        int count = 0;
        for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int x = i + di, y = j + dj;
          if (x < 0 || y < 0 || x >= map.nx || y >= map.ny || !std::isfinite(before[at(x, y)])) continue;
          sum += before[at(x, y)];
          ++count;
        }
        if (count > 0) {
          values[at(i, j)] = sum / count;
          filled_any = true;
        } else {
          has_gaps = true;
        }
      }
    has_gaps = has_gaps && filled_any;
  }
  grid.values.clear();
  for (const double value : values)
    grid.values.push_back(std::isfinite(value) ? static_cast<float>(value - level) : -1.0F);
  return grid;
}

// Makes a <path> through points [px]. @param style  SVG attributes of the line
std::string PathOf(const std::vector<PlotPoint>& points, std::string_view style) {
  std::string path;
  char command = 'M';
  for (const PlotPoint& p : points) {
    path += fmt::format("{}{:.1f} {:.1f}", command, p.x, p.y);
    command = 'L';
  }
  return fmt::format("<path d=\"{}\" fill=\"none\" {}/>\n", path, style);
}

/// The area occupied by a label or a mark of a panel [px].
struct OccupiedBox {
  double left{0.0}, top{0.0}, right{0.0}, bottom{0.0};
  [[nodiscard]] bool Overlaps(const OccupiedBox& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};
using OccupiedBoxes = std::vector<OccupiedBox>;

/// Whether the box overlaps one of the occupied ones.
bool Overlaps(const OccupiedBoxes& taken, const OccupiedBox& box) {
  return std::ranges::any_of(taken, [&box](const OccupiedBox& other) { return other.Overlaps(box); });
}

/// The area that a contour's number occupies around its middle.
OccupiedBox NumberBox(const std::string& text, const PlotPoint& at) {
  const double half = 0.5 * TextWidth(text, kLabelPx) + 3.0;
  return {.left = at.x - half, .top = at.y - 8.0, .right = at.x + half, .bottom = at.y + 8.0};
}

/// Draws the contour lines of all levels, each with its number if there is room. @param taken  the numbers'
/// boxes are added
std::string ContourLines(const HeatMap& map, const PlotArea& area, OccupiedBoxes& taken) {
  std::string out;
  for (const double level : map.contours) {
    std::vector<PlotPoint> longest;
    for (const Polyline& line : Contour(AboveLevel(map, level))) {
      // split the line into the parts in which the map has values
      std::vector<std::vector<PlotPoint>> pieces(1);
      std::vector<Vector2> points = line.points;
      if (line.closed && !points.empty()) points.push_back(points.front());
      for (const Vector2& p : points) {
        const bool has_value = std::isfinite(
            At(map, static_cast<int>(std::lround(p.x())), static_cast<int>(std::lround(p.y()))));
        if (!has_value) {
          if (!pieces.back().empty()) pieces.emplace_back();
          continue;
        }
        pieces.back().push_back({area.left + area.width * p.x() / (map.nx - 1),
                                 area.top + area.height * (1.0 - p.y() / (map.ny - 1))});
      }
      for (const auto& piece : pieces) {
        if (piece.size() < 2) continue;
        out += PathOf(piece, R"(stroke="#ffffff" stroke-width="1.5")");
        if (piece.size() > longest.size()) longest = piece;
      }
    }
    if (longest.size() < 10) continue;  // too short for a number
    // place the number where the line is nearest to horizontal, away from the line's ends and from other
    // labels
    const std::string number = Number(level, 0);
    const auto place = [&](std::size_t k) {
      return PlotPoint{std::clamp(longest[k].x, area.left + 18.0, area.left + area.width - 18.0),
                       longest[k].y};
    };
    std::size_t at = longest.size() / 2;
    double flattest = HUGE_VAL;
    for (std::size_t k = longest.size() / 5 + 2; k + 2 + longest.size() / 5 < longest.size(); ++k) {
      const double slope = std::abs(longest[k + 2].y - longest[k - 2].y) /
                           std::max(0.1, std::abs(longest[k + 2].x - longest[k - 2].x));
      if (slope >= flattest || Overlaps(taken, NumberBox(number, place(k)))) continue;
      flattest = slope;
      at = k;
    }
    const OccupiedBox box = NumberBox(number, place(at));
    if (Overlaps(taken, box)) continue;  // no free place: the line has no number
    taken.push_back(box);
    out += SvgText(place(at).x, place(at).y + 4.0, number, "middle", "#ffffff", kLabelPx,
                   R"(font-weight="600" stroke="#1b1f24" stroke-width="2.6" paint-order="stroke")");
  }
  return out;
}

/// Draws HeatMap's own lines over the map.
std::string OverlayLines(const HeatMap& map, const PlotArea& area) {
  std::string out;
  for (const MapLine& drawn : map.lines) {
    std::vector<PlotPoint> points;
    for (const Vector2& p : drawn.line.points) points.push_back({area.X(p.x()), area.Y(p.y())});
    if (drawn.line.closed && !points.empty()) points.push_back(points.front());
    out +=
        PathOf(points, fmt::format(R"(stroke="{}" stroke-width="{}" stroke-linejoin="round"{})", drawn.color,
                                   drawn.width_px, drawn.dashed ? R"( stroke-dasharray="5 3")" : ""));
  }
  return out;
}

/// Draws marks, each with its label at the first place beside the mark (right, left, above, below, diagonal)
/// that is inside the panel and free; a mark for which there is no such place has no label. @param taken
/// marks and labels are added to it
std::string Marks(const HeatMap& map, const PlotArea& area, OccupiedBoxes& taken) {
  std::string out;
  const auto inside = [&map](const MapMark& mark) {
    return mark.x >= map.x.min && mark.x <= map.x.max && mark.y >= map.y.min && mark.y <= map.y.max;
  };
  for (const MapMark& mark : map.marks)
    if (inside(mark))
      taken.push_back({.left = area.X(mark.x) - 6.0,
                       .top = area.Y(mark.y) - 6.0,
                       .right = area.X(mark.x) + 6.0,
                       .bottom = area.Y(mark.y) + 6.0});
  for (const MapMark& mark : map.marks) {
    if (!inside(mark)) continue;
    const double x = area.X(mark.x), y = area.Y(mark.y);
    out += DrawMarker(x, y, mark.marker, mark.color);
    if (mark.label.empty()) continue;
    // bold text is about a tenth wider
    const double width = 1.1 * TextWidth(mark.label, kLabelPx);
    for (const auto& [dx, dy] : {std::pair{9.0, 4.0},
                                 {-9.0 - width, 4.0},
                                 {-0.5 * width, -9.0},
                                 {-0.5 * width, 17.0},
                                 {9.0, -9.0},
                                 {-9.0 - width, -9.0},
                                 {9.0, 17.0},
                                 {-9.0 - width, 17.0},
                                 {-0.5 * width, 31.0}}) {
      const OccupiedBox box{
          .left = x + dx, .top = y + dy - 10.0, .right = x + dx + width, .bottom = y + dy + 2.0};
      if (box.left < area.left + 2.0 || box.right > area.left + area.width - 2.0 ||
          box.top < area.top + 2.0 || box.bottom > area.top + area.height - 2.0 || Overlaps(taken, box))
        continue;
      taken.push_back(box);
      out += SvgText(box.left, y + dy, mark.label, "start", kTextColor, kLabelPx,
                     R"(font-weight="600" stroke="#ffffff" stroke-width="3" paint-order="stroke")");
      break;
    }
  }
  return out;
}

/// Draws the colour scale with its ticks and label, to the right of (left, top) [px].
std::string ScaleBar(const HeatScale& scale, double left, double top, double height) {
  std::string out;
  const int bands = static_cast<int>(std::lround((scale.max - scale.min) / scale.step));
  out += ViridisBands(left, top, kScaleWidth, height, bands) +
         SvgRect(left, top, kScaleWidth, height, "none",
                 fmt::format(R"(stroke="{}" stroke-width="1")", kAxisColor));
  for (double value = scale.min; value <= scale.max + 1e-9; value += scale.tick_step) {
    const double y = top + height * (1.0 - (value - scale.min) / (scale.max - scale.min));
    out += SvgLine(left + kScaleWidth, y, left + kScaleWidth + 5, y, kAxisColor);
    const bool last = value > scale.max - 1e-9;
    out += SvgText(left + kScaleWidth + 9, y + 4.3, (last ? "\xE2\x89\xA5 " : "") + Number(value, 0));
  }
  const double x = left + kScaleWidth + 58, y = top + 0.5 * height;
  return out + SvgTurnedText(x, y, Fit(scale.label, height), "middle", kTextColor);
}

/// Draws a map with its title and axes. @param picture  title of the whole picture, for the panel's id
std::string DrawPanel(const HeatMap& map, const HeatScale& scale, const PlotArea& area,
                      const std::string& picture) {
  Ticks x_ticks = LinearTicks(area.x, 6);
  const Ticks y_ticks = LinearTicks(area.y, std::max(3, static_cast<int>(area.height / 45.0)));
  SpreadLabels(area, x_ticks);
  // the panel's ids must be unique, because a page may contain several pictures
  const std::string id = fmt::format(
      "map-{:x}", std::hash<std::string>{}(picture + map.title + Pixels(area.left) + Pixels(area.top)));
  std::string body = SvgText(area.left, area.top - 9.0, Fit(map.title, area.width), "start", kTextColor,
                             kFontPx, R"(font-weight="600")");
  body += fmt::format("<clipPath id=\"{}\">{}</clipPath>\n<g clip-path=\"url(#{})\">\n", id,
                      SvgRect(area.left, area.top, area.width, area.height, "#000000"), id);
  OccupiedBoxes taken;
  const std::string marks = Marks(map, area, taken), contours = ContourLines(map, area, taken);
  body += DrawField(map, scale, area) + contours + OverlayLines(map, area) + marks + "</g>\n";
  body += SvgRect(area.left, area.top, area.width, area.height, "none",
                  fmt::format(R"(stroke="{}" stroke-width="1")", kAxisColor));
  body += DrawTickTexts(area, x_ticks, y_ticks);
  return body + DrawAxisLabels(area, map.x_label, area.top + area.height + 38.0, map.y_label,
                               area.left - WidestLabel(y_ticks) - 20.0);
}

}  // namespace

std::string ViridisColor(double share) {
  const std::array<double, 3> rgb = Viridis(share);
  return fmt::format("#{:02x}{:02x}{:02x}", static_cast<int>(std::lround(rgb[0])),
                     static_cast<int>(std::lround(rgb[1])), static_cast<int>(std::lround(rgb[2])));
}

std::string BandColor(int band, int bands) {
  return ViridisColor(bands > 1 ? static_cast<double>(band) / (bands - 1) : 0.0);
}

std::string ViridisBands(double left, double top, double width, double height, int bands) {
  std::string out;
  for (int b = 0; b < bands; ++b)
    out += SvgRect(left, top + height * (1.0 - (b + 1.0) / bands), width, height / bands + 0.4,
                   BandColor(b, bands));
  return out;
}

std::string HeatMapSvg(const std::vector<HeatMap>& panels, int columns, const std::vector<HeatScale>& scales,
                       const std::string& title, const std::vector<LegendEntry>& legend, double width_px) {
  // widths [px]: strip at the right for the colour scale, strip beside each panel for its y axis, left margin
  constexpr double kScaleStrip = kScaleWidth + 92.0, kAxisStrip = 62.0, kLeft = 4.0;
  const LegendBlock block = DrawLegend(kLeft, 2.0, width_px - 8.0, title, legend);
  const double panel_width = (width_px - kScaleStrip - kLeft - kGap * (columns - 1)) / columns;
  std::string body = block.svg;
  double top = block.height_px + 34.0, lowest = top;
  for (std::size_t k = 0; k < panels.size(); ++k) {
    const HeatMap& map = panels[k];
    const int column = static_cast<int>(k) % columns;
    const HeatScale& scale = scales[std::min(k / static_cast<std::size_t>(columns), scales.size() - 1)];
    if (k > 0 && column == 0) top = lowest + 76.0;
    PlotArea area{.x = map.x, .y = map.y};
    area.left = kLeft + column * (panel_width + kGap) + kAxisStrip;
    area.top = top;
    area.width = panel_width - kAxisStrip;
    area.height = area.width * (map.y.max - map.y.min) / (map.x.max - map.x.min);
    lowest = column == 0 ? area.top + area.height : std::max(lowest, area.top + area.height);
    body += DrawPanel(map, scale, area, title);
    if (column == columns - 1 || k + 1 == panels.size())
      body += ScaleBar(scale, width_px - kScaleStrip + 14.0, top, lowest - top);
  }
  return SvgDocument(width_px, lowest + 48.0, title, body);
}

}  // namespace osteon::report
