#pragma once

#include <string>
#include <vector>

#include "report/svg_frame.h"
#include "report/svg_plot.h"

// Draws a field over two logarithmic axes of different units as coloured cells, with curves on top.

namespace osteon::report {

/// One panel. The cells divide each axis into equal parts of its logarithm. Values are stored in rows along
/// x; the row with the lowest y comes first.
struct LevelMap {
  std::string title{};
  std::string x_label{}, y_label{};  ///< with unit
  Range x{1.0, 10.0}, y{1.0, 10.0};  ///< > 0
  int nx{0}, ny{0};                  ///< >= 1
  std::vector<double> values{};      ///< nx times ny values; NaN, or below the scale's min: drawn grey
  std::vector<Series> curves{};      ///< points that are not positive, or outside the panel, are left out
};

/// Bands of colour (viridis) of equal width from min to max; values above max get the last band's colour.
struct LevelScale {
  std::string label{};  ///< with unit
  double min{0.0}, max{1.0};
  int bands{8};
};

/// Draws panels side by side under one title and one legend, the scale at the right.
[[nodiscard]] std::string LevelMapSvg(const std::vector<LevelMap>& panels, const LevelScale& scale,
                                      const std::string& title, const std::vector<LegendEntry>& legend,
                                      double width_px = 920.0);

}  // namespace osteon::report
