#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/svg_frame.h"

// Draws the markers of single points of a plot, and finds places for the points' names.

namespace osteon::report {

/// Draws one marker of about 9 px. Series differ in shape as well as in colour, so that they can be told
/// apart in a grey print.
[[nodiscard]] std::string DrawMarker(double x, double y, Marker marker, std::string_view color,
                                     double opacity = 1.0);

/// Draws an error bar: a vertical line with two short caps, from one pixel row to another.
[[nodiscard]] std::string DrawWhisker(double x, double y_low, double y_high, std::string_view color,
                                      double opacity = 1.0);

/// Finds free places for names beside points. It tries right, left, above and below the point, then places
/// farther out, with a thin line to the point.
class LabelPlacer {
 public:
  explicit LabelPlacer(const PlotArea& area) : area_(area) {}

  /// Reserves a rectangle, which no name will cover.
  void Block(double left, double top, double width, double height);
  /// Reserves a line, as a row of small rectangles.
  void BlockLine(double x1, double y1, double x2, double y2);
  /// Places a name beside the point and reserves the area that the name covers.
  /// @param far  allow places farther out, with a line to the point
  /// @returns the markup; empty if no place is free
  [[nodiscard]] std::string Place(double x, double y, std::string_view text, std::string_view color,
                                  bool far);

 private:
  struct Box {
    double left, top, right, bottom;
  };
  // Whether a name may be drawn in the box: it is inside the plot's area and overlaps nothing reserved.
  [[nodiscard]] bool IsFree(const Box& box) const;

  PlotArea area_;
  std::vector<Box> taken_;  // reserved so far
};

}  // namespace osteon::report
