#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/ticks.h"

// A simple schematic: bone, tool, arm and arrows, in pixels, y downward. Every label has at least 12 px.

namespace osteon::studies {

inline constexpr double kSketchWidth_px = 400.0, kSketchHeight_px = 160.0;
inline constexpr double kSketchFontPx = 12.0;

/// Colours of the lines of a sketch.
inline constexpr const char* kHandColor = "#1b1f24";   ///< the hand's actions: pushes, leads
inline constexpr const char* kWrongColor = "#d55e00";  ///< the baseline's actions
inline constexpr const char* kRightColor = "#0072b2";  ///< our method's actions

/// Style of a line. A dashed line shows an intended or earlier position.
struct SketchLine {
  std::string_view color{kHandColor};
  double width_px{1.6};
  bool dashed{false};
};

/// Style of the line that shows an intended or earlier position.
inline constexpr SketchLine kMeantLine{.color = "#59636e", .dashed = true};

/// Draws the elements of one half of a scene. Coordinates are within kSketchWidth_px × kSketchHeight_px;
/// `left` and `top` are that area's position in the picture [px].
class SceneSketch {
 public:
  SceneSketch(double left, double top, bool ours) : left_(left), top_(top), ours_(ours) {}

  /// Whether this half shows our method; otherwise it shows the baseline.
  [[nodiscard]] bool ours() const { return ours_; }
  /// The colour and the line for the actions of this half's method.
  [[nodiscard]] const char* color() const { return ours_ ? kRightColor : kWrongColor; }
  [[nodiscard]] SketchLine Strong() const { return {.color = color(), .width_px = 2.4}; }
  [[nodiscard]] const std::string& svg() const { return svg_; }

  void Bone(const std::vector<report::PlotPoint>& outline, std::string_view fill = "#f1e4c8");
  void BoneBlock(double left, double top, double right, double bottom, std::string_view fill = "#f1e4c8");
  void BoneBall(double x, double y, double radius);
  /// Part of a tool.
  void Tool(const std::vector<report::PlotPoint>& outline);
  void ToolBall(double x, double y, double radius);
  /// A ball that is not at its actual place: where the hand holds its tool, or an earlier position.
  void GhostBall(double x, double y, double radius, std::string_view color = "#59636e");
  void Line(const std::vector<report::PlotPoint>& points, const SketchLine& line = {});
  void Arrow(report::PlotPoint from, report::PlotPoint to, const SketchLine& line = {});
  /// The links of a robot arm, with joints at all points but the last.
  void Arm(const std::vector<report::PlotPoint>& points);
  void Cross(double x, double y, std::string_view color);
  void Box(double left, double top, double width, double height);
  /// A text. `anchor` is start, middle or end; `y` the text's baseline.
  void Text(double x, double y, std::string_view text, std::string_view anchor = "start",
            std::string_view color = "#1b1f24");

 private:
  [[nodiscard]] std::string Path(const std::vector<report::PlotPoint>& points) const;

  double left_, top_;
  bool ours_;
  std::string svg_;
};

/// Points of an arc, in steps of at most 4 deg; angles count from +x towards +y (downward) [deg].
[[nodiscard]] std::vector<report::PlotPoint> ArcPoints(report::PlotPoint center, double radius,
                                                       double from_deg, double to_deg);
/// Points of a sine wave about y = from.y, from x = `from.x` to `to_x`. Its amplitude changes linearly from
/// the first to the last of `amplitudes` [px].
[[nodiscard]] std::vector<report::PlotPoint> WavePoints(report::PlotPoint from, double to_x, double turns,
                                                        std::pair<double, double> amplitudes);

}  // namespace osteon::studies
