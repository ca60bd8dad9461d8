#include "studies/failures/page/scene_sketch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "report/svg_frame.h"
#include "report/svg_text.h"

namespace osteon::studies {
namespace {

constexpr const char* kBoneEdge = "#b3995c";
constexpr const char* kToolFill = "#dfe5ea";
constexpr const char* kToolEdge = "#59636e";

std::string Circle(double x, double y, double radius, std::string_view style) {
  return fmt::format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" {}/>\n", report::Pixels(x), report::Pixels(y),
                     report::Pixels(radius), style);
}

std::string FillStyle(std::string_view fill, std::string_view edge) {
  return fmt::format(R"(fill="{}" stroke="{}" stroke-width="1.2" stroke-linejoin="round")", fill, edge);
}

}  // namespace

std::string SceneSketch::Path(const std::vector<report::PlotPoint>& points) const {
  std::string path;
  for (const report::PlotPoint& p : points)
    path += fmt::format("{}{} {}", path.empty() ? 'M' : 'L', report::Pixels(left_ + p.x),
                        report::Pixels(top_ + p.y));
  return path;
}

void SceneSketch::Bone(const std::vector<report::PlotPoint>& outline, std::string_view fill) {
  svg_ += fmt::format("<path d=\"{}Z\" {}/>\n", Path(outline), FillStyle(fill, kBoneEdge));
}

void SceneSketch::BoneBlock(double left, double top, double right, double bottom, std::string_view fill) {
  Bone({{left, top}, {right, top}, {right, bottom}, {left, bottom}}, fill);
}

void SceneSketch::BoneBall(double x, double y, double radius) {
  svg_ += Circle(left_ + x, top_ + y, radius, FillStyle("#f1e4c8", kBoneEdge));
}

void SceneSketch::Tool(const std::vector<report::PlotPoint>& outline) {
  svg_ += fmt::format("<path d=\"{}Z\" {}/>\n", Path(outline), FillStyle(kToolFill, kToolEdge));
}

void SceneSketch::ToolBall(double x, double y, double radius) {
  svg_ += Circle(left_ + x, top_ + y, radius, FillStyle(kToolFill, kToolEdge));
}

void SceneSketch::GhostBall(double x, double y, double radius, std::string_view color) {
  svg_ += Circle(left_ + x, top_ + y, radius,
                 fmt::format(R"(fill="none" stroke="{}" stroke-width="1.3" stroke-dasharray="4 3")", color));
}

void SceneSketch::Line(const std::vector<report::PlotPoint>& points, const SketchLine& line) {
  svg_ += fmt::format(R"(<path d="{}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round"{}/>)"
                      "\n",
                      Path(points), line.color, report::Pixels(line.width_px),
                      line.dashed ? R"( stroke-dasharray="5 3.5")" : "");
}

void SceneSketch::Arrow(report::PlotPoint from, report::PlotPoint to, const SketchLine& line) {
  const double length = std::hypot(to.x - from.x, to.y - from.y);
  if (!(length > 0.0)) return;
  const double head = std::min(4.5 + 2.0 * line.width_px, length), ux = (to.x - from.x) / length,
               uy = (to.y - from.y) / length;
  const report::PlotPoint neck{to.x - head * ux, to.y - head * uy};
  Line({from, neck}, line);
  const double half = 0.45 * head;
  svg_ += fmt::format(
      "<path d=\"{}Z\" fill=\"{}\"/>\n",
      Path({to, {neck.x - half * uy, neck.y + half * ux}, {neck.x + half * uy, neck.y - half * ux}}),
      line.color);
}

void SceneSketch::Arm(const std::vector<report::PlotPoint>& points) {
  Line(points, {.color = "#c3cbd2", .width_px = 9.0});
  for (std::size_t i = 0; i + 1 < points.size(); ++i)
    svg_ += Circle(left_ + points[i].x, top_ + points[i].y, 6.0, FillStyle("#ffffff", kToolEdge));
}

void SceneSketch::Cross(double x, double y, std::string_view color) {
  for (const double side : {-1.0, 1.0})
    Line({{x - 5.0, y - 5.0 * side}, {x + 5.0, y + 5.0 * side}}, {.color = color, .width_px = 2.2});
}

void SceneSketch::Box(double left, double top, double width, double height) {
  svg_ += report::SvgRect(left_ + left, top_ + top, width, height, "#f5f7f9",
                          fmt::format(R"(stroke="{}" rx="4")", kToolEdge));
}

void SceneSketch::Text(double x, double y, std::string_view text, std::string_view anchor,
                       std::string_view color) {
  svg_ += report::SvgText(left_ + x, top_ + y, text, anchor, color, kSketchFontPx);
}

std::vector<report::PlotPoint> ArcPoints(report::PlotPoint center, double radius, double from_deg,
                                         double to_deg) {
  const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(to_deg - from_deg) / 4.0)));
  std::vector<report::PlotPoint> points;
  for (int i = 0; i <= steps; ++i) {
    const double angle =
        std::lerp(from_deg, to_deg, static_cast<double>(i) / steps) * std::numbers::pi / 180.0;
    points.push_back({center.x + radius * std::cos(angle), center.y + radius * std::sin(angle)});
  }
  return points;
}

std::vector<report::PlotPoint> WavePoints(report::PlotPoint from, double to_x, double turns,
                                          std::pair<double, double> amplitudes) {
  const int steps = std::max(2, static_cast<int>(24.0 * turns));
  std::vector<report::PlotPoint> points;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    points.push_back({std::lerp(from.x, to_x, t), from.y - std::lerp(amplitudes.first, amplitudes.second, t) *
                                                               std::sin(2.0 * std::numbers::pi * turns * t)});
  }
  return points;
}

}  // namespace osteon::studies
