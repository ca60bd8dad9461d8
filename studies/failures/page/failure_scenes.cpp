#include "studies/failures/page/failure_scenes.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/svg_frame.h"
#include "report/svg_text.h"

namespace osteon::studies {
namespace {

// Margin of the picture, space between its halves, and height of the headings [px].
constexpr double kMargin = 8.0, kGap = 4.0, kHeading = 24.0;

/// @returns null if no scene has that number
const FailureScene* FindScene(int id) {
  for (const std::span<const FailureScene> scenes :
       {ContactScenes(), CuttingScenes(), ArmScenes(), GuidanceScenes(), PlanScenes(), SequenceScenes(),
        ComplianceScenes()})
    if (const auto found = std::ranges::find(scenes, id, &FailureScene::id); found != scenes.end())
      return &*found;
  return nullptr;
}

/// Heading, sketch and caption of one half. @returns elements, and the height down to the caption's end.
report::LegendBlock DrawHalf(const FailureScene& scene, double left, bool ours) {
  SceneSketch sketch(left, kHeading, ours);
  scene.draw(sketch);
  std::string svg = report::SvgText(left, 16.0, ours ? "ours" : "baseline", "start", sketch.color(),
                                    report::kFontPx, R"(font-weight="600")") +
                    sketch.svg();
  double y = kHeading + kSketchHeight_px + 4.0;
  for (const std::string& line : report::Wrap(ours ? scene.ours : scene.baseline, kSketchWidth_px - 12.0))
    svg += report::SvgText(left, y += report::kLabelLinePx, line, "start", report::kMutedColor);
  return {.svg = svg, .height_px = y + 8.0};
}

}  // namespace

std::string FailureSceneSvg(int id, const std::string& name) {
  const FailureScene* scene = FindScene(id);
  if (scene == nullptr) return {};
  const double right = kMargin + kSketchWidth_px + kGap;
  const report::LegendBlock baseline = DrawHalf(*scene, kMargin, false), ours = DrawHalf(*scene, right, true);
  const double height = std::max(baseline.height_px, ours.height_px);
  return report::SvgDocument(
      right + kSketchWidth_px + kMargin, height, fmt::format("{} {}: the scene", id, name),
      baseline.svg + report::SvgLine(right - 6.0, 6.0, right - 6.0, height - 6.0, report::kGridColor) +
          ours.svg);
}

}  // namespace osteon::studies
