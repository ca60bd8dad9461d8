#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/svg_frame.h"

// Single points of a plot: what they look like, and where their names fit.

namespace osteon::app {

/// One marker of about 9 px. Shapes differ as well as colours, so that a print in grey still tells them
/// apart.
[[nodiscard]] std::string DrawMarker(double x, double y, Marker marker, std::string_view color,
                                     double opacity = 1.0);

/// A vertical bar with two short caps, from one pixel row to another.
[[nodiscard]] std::string DrawWhisker(double x, double y_low, double y_high, std::string_view color,
                                      double opacity = 1.0);

/// Finds free places for names beside points: right, left, above, below, then further out with a thin line.
class LabelPlacer {
 public:
  explicit LabelPlacer(const PlotArea& area) : area_(area) {}

  /// Nothing is written over this.
  void Block(double left, double top, double width, double height);
  /// The same for a line, in short pieces.
  void BlockLine(double x1, double y1, double x2, double y2);
  /// A name beside the point; empty where none of the places is free. What it returns is blocked from then
  /// on.
  /// @param far  places with a line to the point may be taken
  [[nodiscard]] std::string Place(double x, double y, std::string_view text, std::string_view color,
                                  bool far);

 private:
  struct Box {
    double left, top, right, bottom;
  };
  [[nodiscard]] bool Free(const Box& box) const;

  PlotArea area_;
  std::vector<Box> taken_;
};

}  // namespace osteon::app
