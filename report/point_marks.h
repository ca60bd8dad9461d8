#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "report/svg_frame.h"

// Single points of a plot: draws their markers and finds places for their names.

namespace osteon::report {

/// Draws one marker of about 9 px. Series differ in shape as well as in colour, so that a grey print tells
/// them apart.
[[nodiscard]] std::string DrawMarker(double x, double y, Marker marker, std::string_view color,
                                     double opacity = 1.0);

/// Draws a vertical bar with two short caps, from one pixel row to another.
[[nodiscard]] std::string DrawWhisker(double x, double y_low, double y_high, std::string_view color,
                                      double opacity = 1.0);

/// Finds free places for names beside points: right, left, above, below, then farther out with a thin line.
class LabelPlacer {
 public:
  explicit LabelPlacer(const PlotArea& area) : area_(area) {}

  /// Reserves a rectangle that names must not cover.
  void Block(double left, double top, double width, double height);
  /// Reserves a line, as a row of small rectangles.
  void BlockLine(double x1, double y1, double x2, double y2);
  /// Places a name beside the point and reserves its place.
  /// @param far  allow places farther out, with a line to the point
  /// @returns the markup; empty if no place is free
  [[nodiscard]] std::string Place(double x, double y, std::string_view text, std::string_view color,
                                  bool far);

 private:
  struct Box {
    double left, top, right, bottom;
  };
  // Whether a text may stand in the box: inside the plot's area, and nothing reserved in it.
  [[nodiscard]] bool IsFree(const Box& box) const;

  PlotArea area_;
  std::vector<Box> taken_;  // reserved so far
};

}  // namespace osteon::report
