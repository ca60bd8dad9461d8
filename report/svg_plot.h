#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/svg_frame.h"
#include "report/ticks.h"

// Makes plots as SVG text, without a library and without a script. Texts never overlap: title, legend, names
// of spans and axis labels each have a strip that is sized for its text.
//
//     title      ─── series a   ─── series b          <- wraps into rows
//            name of span │ name of span
//      200 ┤·············│··················│ limit   <- right margin as wide as the widest limit label
//   y    0 ┤─────────────│──────────────────│
//          0      2      4      6      8   10
//                        x

namespace osteon::report {

/// A curve or a set of points.
struct Series {
  std::string name{};
  std::vector<double> x{}, y{};  ///< same length; non-finite points leave a gap
  std::string color{};           ///< empty: the next colour of the palette
  double width_px{1.4};          ///< width of the line; 0: only points are drawn
  Marker marker{Marker::kNone};
  std::vector<double> y_low{}, y_high{};  ///< ends of error bars; empty, or as many as x
  std::vector<std::string> labels{};      ///< names written beside the points; empty, or as many as x
  /// Opacity of line and points. If there is no room for all labels, those of pale series are left out first.
  double opacity{1.0};
  std::string dash{};  ///< dash pattern of the line, as SVG's stroke-dasharray; empty: solid
};

/// A line at a limit value: horizontal in LineChart::limits, vertical in LineChart::x_limits.
struct LimitLine {
  double value{0.0};
  std::string label{};  ///< written in the right margin
};

/// A part of the x axis with a name.
struct NamedSpan {
  double begin{0.0}, end{0.0};
  std::string name{};
  std::string color{"#f1e4c8"};
};

/// One panel: series over common axes, with limits and named spans.
struct LineChart {
  std::string title{};
  std::string x_label{}, y_label{};  ///< with unit, e.g. "time [s]"
  std::optional<Range> x{}, y{};     ///< default: from the data
  bool y_from_zero{true};  ///< true: a y range that is derived from the data contains 0; ignored with log_y
  /// Logarithmic axes. Values that are not positive are left out. The log_x of the first panel applies to all
  /// panels.
  bool log_x{false}, log_y{false};
  std::vector<Series> series{};
  std::vector<LimitLine> limits{};
  /// Vertical lines. Their names are written along them, where they cover no curve if possible.
  std::vector<LimitLine> x_limits{};
  std::vector<NamedSpan> spans{};
  bool legend{true};
  /// The x axis is the time of the page's run, and the page's script may move and zoom it together with the
  /// page's other plots. The curves then keep more points than are visible at first. The first panel's value
  /// applies to all panels. Not for series with markers.
  bool zooms{false};
  double plot_height_px{230.0};  ///< height of the area between the axes
};

/// Draws panels one above the other with one common x axis, whose ticks and label are below the last panel. A
/// panel without a single finite point says "no data".
/// @returns one <svg> element with its size in px and a viewBox.
[[nodiscard]] std::string Svg(std::span<const LineChart> panels, double width_px = 920.0);
[[nodiscard]] inline std::string Svg(const LineChart& chart, double width_px = 920.0) {
  return Svg(std::span(&chart, 1), width_px);
}

/// Draws panels in rows, each with its own axes, under one title and one legend.
[[nodiscard]] std::string SvgGrid(std::span<const LineChart> panels, int columns, const std::string& title,
                                  const std::vector<LegendEntry>& legend, double width_px);

/// A histogram: bars that show how often values occurred.
struct Histogram {
  std::string title{};
  std::string x_label{};               ///< with unit
  std::vector<double> values{};        ///< values that are not finite are not counted
  std::vector<std::uint64_t> times{};  ///< number of occurrences of each value; empty: once each
  bool log_x{false};                   ///< values that are not positive go into the lowest bin
  bool log_y{false};  ///< true: logarithmic counts, so that a single outlier among thousands is visible
  int bins{60};
  std::string y_label{"count"};
  std::string unit{};      ///< unit of the percentiles in the legend
  bool percentiles{true};  ///< lines at the median, 99 %, 99.9 % and the maximum
  double plot_height_px{200.0};
};

[[nodiscard]] std::string Svg(const Histogram& histogram, double width_px = 450.0);

}  // namespace osteon::report
