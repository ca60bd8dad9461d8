#pragma once

#include <string>
#include <vector>

#include "report/contour.h"
#include "report/svg_frame.h"

// Draws a field over a plane as bands of colour with contour lines. Both axes have the same scale; a colour
// scale stands beside each row of panels.
//
//     title                                     ┌──┐ 400
//     ┌────────────────┐  ┌────────────────┐    │  │
//     │   ▒▒▒▒▓▓▓▓     │  │                │    ├──┤ 200
//     │  ▒▒▒▓▓▓▓▓▓─200─│  │                │    │  │
//     └────────────────┘  └────────────────┘    └──┘ 0 N

namespace osteon::report {

/// A line drawn over a map, in its axes' units.
struct MapLine {
  Polyline line{};
  std::string color{"#1b1f24"};
  double width_px{1.4};
  bool dashed{false};
};

/// A marked point of a map, in its axes' units.
struct MapMark {
  double x{0.0}, y{0.0};
  Marker marker{Marker::kCircle};
  std::string color{"#1b1f24"};
  std::string label{};
};

/// One panel. Node (i, j) is at x = x.min + i (x.max - x.min) / (nx - 1), and y with j and ny in the same
/// way.
struct HeatMap {
  std::string title{};
  std::string x_label{}, y_label{};  ///< with unit
  Range x{}, y{};                    ///< in the same unit, because both axes are drawn with equal scales
  int nx{0}, ny{0};                  ///< >= 2
  std::vector<double> values{};      ///< nx times ny values, row by row along x; NaN: no value, drawn grey
  std::vector<double> contours{};    ///< levels at which a line with a number is drawn
  std::vector<MapLine> lines{};
  std::vector<MapMark> marks{};
};

/// The colours of a row of panels: viridis in bands of `step`; values above max get the last band's colour.
struct HeatScale {
  std::string label{};  ///< with unit
  double min{0.0}, max{400.0}, step{25.0};
  double tick_step{100.0};
};

/// The colour of a fraction 0 … 1 of a scale: viridis (van der Walt and Smith, 2015), "#rrggbb".
[[nodiscard]] std::string ViridisColor(double share);
/// The colour of one of a scale's bands, numbered from its low end.
[[nodiscard]] std::string BandColor(int band, int bands);
/// Draws the bands of a scale, one above the other, the low end at the bottom.
[[nodiscard]] std::string ViridisBands(double left, double top, double width, double height, int bands);

/// Draws panels in rows, under one title and one legend, each row with its scale at the right.
/// @param scales  one per row of panels; the last scale is also used for all further rows
[[nodiscard]] std::string HeatMapSvg(const std::vector<HeatMap>& panels, int columns,
                                     const std::vector<HeatScale>& scales, const std::string& title,
                                     const std::vector<LegendEntry>& legend, double width_px = 920.0);

}  // namespace osteon::report
