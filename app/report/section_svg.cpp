#include <cmath>
#include <fstream>

#include <fmt/format.h>

#include "app/report/section.h"
#include "app/report/svg_frame.h"
#include "app/report/svg_text.h"

namespace osteon::app {
namespace {

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

std::string Path(const std::vector<Polyline>& lines, const PlotArea& area, std::string_view style) {
  if (lines.empty()) return {};
  return fmt::format("<path d=\"{}\" {}/>\n", PathData(lines, area), style);
}

}  // namespace

std::string SectionSvg(const Section& section, const simulation::Bone& bone, double width_px) {
  // equal axes: the height follows from the width
  PlotArea area{.x = {1e3 * section.min.x(), 1e3 * section.max.x()},
                .y = {1e3 * section.min.y(), 1e3 * section.max.y()}};
  const double extent_x = area.x.max - area.x.min, extent_y = area.y.max - area.y.min;
  const int y_count = std::max(2, static_cast<int>(extent_y / std::max(extent_x, 1e-9) * 12.0));
  const Ticks x_ticks = LinearTicks(area.x, 12), y_ticks = LinearTicks(area.y, y_count);
  area.left = WidestLabel(y_ticks) + 33.0;
  area.width = width_px - area.left - 18.0;
  area.height = area.width * extent_y / extent_x;

  std::vector<LegendEntry> legend;
  for (const MaterialRegion& region : section.materials)
    legend.push_back({.text = region.material < bone.materials.size()
                                  ? bone.materials[region.material].name
                                  : fmt::format("material {}", region.material),
                      .color = MaterialTint(bone, region.material),
                      .mark = LegendEntry::Mark::kFill});
  if (section.materials.empty())
    legend.push_back({.text = "bone", .color = "#efe6da", .mark = LegendEntry::Mark::kFill});
  legend.push_back({.text = "before", .color = kAxisColor, .mark = LegendEntry::Mark::kDash});
  legend.push_back({.text = "after", .color = kTextColor});
  if (!section.swept.empty()) legend.push_back({.text = "swept by the tool", .color = kPalette[1]});
  const LegendBlock block = DrawLegend(area.left, 2.0, area.width, "Section through the cup's axis", legend);
  area.top = 2.0 + block.height_px + 6.0;

  std::string body = block.svg + DrawGrid(area, x_ticks, y_ticks);
  // bone as left, coloured by material inside its outline; ids carry the name so that several drawings fit on
  // one page
  if (!section.after.empty()) {
    const std::string id = fmt::format("bone-{:x}", std::hash<std::string>{}(PathData(section.after, area)));
    body += fmt::format("<clipPath id=\"{}\"><path d=\"{}\" clip-rule=\"evenodd\"/></clipPath>\n", id,
                        PathData(section.after, area));
    body += Path(section.after, area, R"(fill="#efe6da" fill-rule="evenodd")");
    body += fmt::format("<g clip-path=\"url(#{})\">\n", id);
    for (const MaterialRegion& region : section.materials)
      body += Path(region.outline, area,
                   fmt::format(R"(fill="{}" fill-rule="evenodd")", MaterialTint(bone, region.material)));
    body += "</g>\n";
  }
  body +=
      Path(section.before, area,
           fmt::format(R"(fill="none" stroke="{}" stroke-width="1.3" stroke-dasharray="5 3")", kAxisColor));
  body +=
      Path(section.after, area,
           fmt::format(R"(fill="none" stroke="{}" stroke-width="1.2" stroke-linejoin="round")", kTextColor));
  body +=
      Path(section.swept, area, fmt::format(R"(fill="none" stroke="{}" stroke-width="1.5")", kPalette[1]));
  if (section.before.empty())
    body += SvgText(area.left + area.width / 2, area.top + area.height / 2, "no bone in this plane", "middle",
                    kMutedColor);
  body += DrawTickTexts(area, x_ticks, y_ticks);
  const double bottom = area.top + area.height;
  body += DrawAxisLabels(area, "across the cup [mm]", bottom + 38, "along the cup's axis [mm]", 14.0);
  return SvgDocument(width_px, bottom + 46.0, "Section through the cup", body);
}

tl::expected<void, std::string> WriteSectionSvg(const Section& section, const simulation::Bone& bone,
                                                const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary);
  file << SectionSvg(section, bone);
  file.close();
  if (!file) return tl::unexpected(path.string() + ": cannot write the section");
  return {};
}

}  // namespace osteon::app
