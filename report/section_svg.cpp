#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>

#include "report/section.h"
#include "report/svg_frame.h"
#include "report/svg_text.h"

namespace osteon::report {
namespace {

constexpr const char* kBoneTint = "#efe6da";  // colour of bone with unknown material

/// Makes the data of a <path> from lines in metres; the area's axes are in millimetres.
std::string PathData(const std::vector<Polyline>& lines, const PlotArea& area) {
  std::string path;
  for (const Polyline& line : lines) {
    char command = 'M';
    for (const Vector2& p : line.points) {
      path += fmt::format("{}{:.2f} {:.2f}", command, area.X(1e3 * p.x()), area.Y(1e3 * p.y()));
      command = 'L';
    }
    if (line.closed) path += 'Z';
  }
  return path;
}

/// Makes a <path> of lines in metres; empty text if there is no line. @param style  its SVG attributes
std::string Path(const std::vector<Polyline>& lines, const PlotArea& area, std::string_view style) {
  if (lines.empty()) return {};
  return fmt::format("<path d=\"{}\" {}/>\n", PathData(lines, area), style);
}

/// The window of the drawing, and its title.
struct Window {
  Vector2 min, max;
  std::string_view title;
  bool legend{true};
};

std::vector<LegendEntry> Legend(const Section& section, const simulation::Bone& bone) {
  std::vector<LegendEntry> legend;
  for (const MaterialRegion& region : section.materials) {
    const bool named = region.material < bone.materials.size();
    legend.push_back(
        {.text = named ? bone.materials[region.material].name : fmt::format("material {}", region.material),
         .color = MaterialTint(bone, region.material),
         .mark = LegendEntry::Mark::kFill});
  }
  if (section.materials.empty())
    legend.push_back({.text = "bone", .color = kBoneTint, .mark = LegendEntry::Mark::kFill});
  if (section.swept.empty()) {  // nothing was cut: both outlines are the same
    legend.push_back({.text = "outline of the spheres", .color = kTextColor});
    return legend;
  }
  legend.push_back({.text = "before", .color = kMutedColor, .mark = LegendEntry::Mark::kDash});
  legend.push_back({.text = "after", .color = kTextColor});
  legend.push_back({.text = "swept by the tool", .color = kPalette[1]});
  return legend;
}

/// Draws the part of a section that is in the window.
std::string DrawWindow(const Section& section, const simulation::Bone& bone, const Window& window,
                       double width_px) {
  // both axes have the same scale, so the height follows from the width
  PlotArea area{.x = {1e3 * window.min.x(), 1e3 * window.max.x()},
                .y = {1e3 * window.min.y(), 1e3 * window.max.y()}};
  const double extent_x = area.x.max - area.x.min, extent_y = area.y.max - area.y.min;
  const int y_count = std::max(2, static_cast<int>(extent_y / extent_x * 12.0));
  const Ticks x_ticks = LinearTicks(area.x, 12), y_ticks = LinearTicks(area.y, y_count);
  area.left = WidestLabel(y_ticks) + 33.0;
  area.width = width_px - area.left - 18.0;
  area.height = area.width * extent_y / extent_x;
  const LegendBlock block = DrawLegend(area.left, 2.0, area.width, window.title,
                                       window.legend ? Legend(section, bone) : std::vector<LegendEntry>{});
  area.top = 2.0 + block.height_px + 6.0;
  std::string body = block.svg + DrawGrid(area, x_ticks, y_ticks);

  // the remaining bone, coloured by material inside its outline
  const std::string solid = PathData(section.solid, area);
  // ids of clip paths must be unique in a page with several drawings, so make them from a hash of the drawing
  const std::string id = fmt::format("section-{:x}", std::hash<std::string>{}(solid + Pixels(area.x.min)));
  body += fmt::format("<clipPath id=\"{}-window\">{}</clipPath>\n", id,
                      SvgRect(area.left, area.top, area.width, area.height, "#000000"));
  body += fmt::format("<g clip-path=\"url(#{}-window)\">\n", id);
  if (!section.solid.empty()) {
    body += fmt::format("<clipPath id=\"{}-bone\"><path d=\"{}\" clip-rule=\"evenodd\"/></clipPath>\n", id,
                        solid);
    body += Path(section.solid, area, fmt::format(R"(fill="{}" fill-rule="evenodd")", kBoneTint));
    body += fmt::format("<g clip-path=\"url(#{}-bone)\">\n", id);
    for (const MaterialRegion& region : section.materials)
      body += Path(region.outline, area,
                   fmt::format(R"(fill="{}" fill-rule="evenodd")", MaterialTint(bone, region.material)));
    body += "</g>\n";
  }
  body +=
      Path(section.before, area,
           fmt::format(R"(fill="none" stroke="{}" stroke-width="1.2" stroke-dasharray="5 3")", kMutedColor));
  body +=
      Path(section.after, area,
           fmt::format(R"(fill="none" stroke="{}" stroke-width="2" stroke-linejoin="round")", kTextColor));
  body +=
      Path(section.swept, area, fmt::format(R"(fill="none" stroke="{}" stroke-width="1.2")", kPalette[1]));
  body += "</g>\n";
  if (section.before.empty())
    body += SvgText(area.left + area.width / 2, area.top + area.height / 2, "no bone in this plane", "middle",
                    kMutedColor);
  body += DrawTickTexts(area, x_ticks, y_ticks);
  const double bottom = area.top + area.height;
  body +=
      DrawAxisLabels(area, "across the site's axis [mm]", bottom + 38, "along the site's axis [mm]", 14.0);
  return SvgDocument(width_px, bottom + 46.0, "Section through the site", body);
}

}  // namespace

std::string SectionSvg(const Section& section, const simulation::Bone& bone, double width_px) {
  return DrawWindow(section, bone, {section.min, section.max, ""}, width_px);
}

std::string SectionDetailSvg(const Section& section, const simulation::Bone& bone, double width_px) {
  if (!(section.head_radius_m > 0.0)) return {};
  // centre of the detail: the head's apex or, if the apex cut nothing, the middle of the cut outline
  if (section.samples.empty()) return {};
  constexpr double kUnderTheApex_rad = 0.08;  // a sample at most this far from the axis was cut by the apex
  const bool at_apex =
      std::any_of(section.samples.begin(), section.samples.end(),
                  [](const ErrorSample& sample) { return std::abs(sample.angle_rad) < kUnderTheApex_rad; });
  const Vector2 middle = at_apex ? Vector2(section.head_center - Vector2(0.0, section.head_radius_m))
                                 : section.samples[section.samples.size() / 2].place_m;
  const double half_m = 0.16 * section.head_radius_m;
  const Vector2 low = middle - Vector2(half_m, 0.3 * half_m), high = middle + Vector2(half_m, 0.3 * half_m);
  return DrawWindow(section, bone,
                    {low, high, at_apex ? "Detail at the deepest place" : "Detail of the cut", false},
                    width_px);
}

}  // namespace osteon::report
