#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/ticks.h"

// The parts of every plot: elements, the plot area with its axes, and a legend that wraps.

namespace osteon::report {

inline constexpr double kFontPx = 12.5;       ///< font size of texts
inline constexpr double kTitlePx = 14.5;      ///< font size of titles
inline constexpr double kLegendRowPx = 20.0;  ///< distance from one row of a legend to the next
/// Height of the strip above a plot that names its shaded spans of x; also the width of a turned axis label.
inline constexpr double kLabelStripPx = 19.0;

/// Makes a <text> element. `anchor` is start, middle or end; `extra` is further attributes.
[[nodiscard]] std::string SvgText(double x, double y, std::string_view text,
                                  std::string_view anchor = "start", std::string_view color = "#1b1f24",
                                  double size_px = kFontPx, std::string_view extra = {});
/// Makes a <text> element that is turned by 90° and runs upward from (x, y).
[[nodiscard]] std::string SvgTurnedText(double x, double y, std::string_view text, std::string_view anchor,
                                        std::string_view color, double size_px = kFontPx);
[[nodiscard]] std::string SvgLine(double x1, double y1, double x2, double y2, std::string_view color,
                                  double width_px = 1.0, std::string_view dash = {});
[[nodiscard]] std::string SvgRect(double x, double y, double width, double height, std::string_view fill,
                                  std::string_view extra = {});
/// Makes <svg …> body </svg> with a white background.
[[nodiscard]] std::string SvgDocument(double width, double height, std::string_view title,
                                      std::string_view body);

/// The rectangle in which data are drawn, and the range of values along each axis.
struct PlotArea {
  double left{0.0}, top{0.0}, width{0.0}, height{0.0};  ///< [px]
  Range x{}, y{};
  bool log_x{false}, log_y{false};

  /// Returns the pixel coordinate of a value on the axis.
  [[nodiscard]] double X(double value) const;
  [[nodiscard]] double Y(double value) const;
};

/// Draws the grid lines and the frame around the area, below the data.
[[nodiscard]] std::string DrawGrid(const PlotArea& area, const Ticks& x, const Ticks& y);
/// Draws the marks of the ticks and their texts, above the data.
[[nodiscard]] std::string DrawTickTexts(const PlotArea& area, const Ticks& x, const Ticks& y);
/// Draws the axes' labels. @param x_label_y  baseline of the x label  @param y_label_x  middle of the turned
/// y label, or of its last line if it wraps (AxisLabelLines)
[[nodiscard]] std::string DrawAxisLabels(const PlotArea& area, std::string_view x_label, double x_label_y,
                                         std::string_view y_label, double y_label_x);
/// Wraps a y label into lines that fit an area of this height.
[[nodiscard]] std::vector<std::string> AxisLabelLines(std::string_view y_label, double height_px);
inline constexpr double kLabelLinePx = 15.0;  ///< distance from one line of a wrapped text to the next
/// Width of the widest of the labels [px].
[[nodiscard]] double WidestLabel(const Ticks& ticks);
/// Removes the labels of x ticks that would be closer than a digit's width to the label before; the tick
/// marks stay.
void SpreadLabels(const PlotArea& area, Ticks& x);

/// The shape of a single point (point_marks.h).
enum class Marker { kNone, kCircle, kRing, kSquare, kTriangle, kDiamond, kDown, kCross, kOpenUp };

/// A legend's entry: a line, a dashed line, a filled square or a marker alone, and a text.
struct LegendEntry {
  enum class Mark { kLine, kDash, kFill, kNone };
  std::string text{};
  std::string color{};
  Mark mark{Mark::kLine};
  Marker marker{Marker::kNone};  ///< drawn on top of the line
};

/// SVG elements and the height that they occupy.
struct LegendBlock {
  std::string svg{};
  double height_px{0.0};
};

/// Draws title and legend from (x, y) down, within `width_px`; the title wraps into lines and the entries
/// into rows. An entry too wide for a row is cut with an ellipsis.
[[nodiscard]] LegendBlock DrawLegend(double x, double y, double width_px, std::string_view title,
                                     const std::vector<LegendEntry>& entries);

/// Breaks `text` at spaces into lines of at most `width_px`; a single wider word is cut (Fit).
[[nodiscard]] std::vector<std::string> Wrap(std::string_view text, double width_px, double size_px = kFontPx);

/// Returns `text`, cut with an ellipsis if it is wider than `width_px`.
[[nodiscard]] std::string Fit(std::string_view text, double width_px, double size_px = kFontPx);

}  // namespace osteon::report
