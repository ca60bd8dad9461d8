#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "report/pareto.h"

namespace osteon::studies {

/// A point of a chart of error over time: x is the frame time, y the error.
struct RivalPoint {
  report::CostPoint cost;
  bool ours{false};
};

/// A point of ours that other methods beat, and their points, each with a smaller time and a smaller error.
struct BeatenPoint {
  std::size_t ours{0};            ///< index of our point
  std::vector<std::size_t> by{};  ///< indices of the other methods' points
};

/// Compares other methods' points with ours. All values are indices of points, in the points' order.
///
///     error │   o   ours: o            a  ahead: no point of ours is both as fast and as exact
///           │ f   a                    f  faster than every point of ours
///           │       o b                b  neither of the two
///           │           o
///           └──────────────── time     beat_all_ours: left of all o and below all o.
struct Dominance {
  bool ours_measured{false};  ///< otherwise the rest is empty
  /// Points with a smaller time and a smaller error than every point of ours.
  std::vector<std::size_t> beat_all_ours{};
  /// Our points that at least one other point beats in time and in error.
  std::vector<BeatenPoint> beaten{};
  /// Other methods' points for which no point of ours is both as fast and as exact. The points of
  /// `faster_than_all_ours` are not repeated here.
  std::vector<std::size_t> ahead{};
  std::vector<std::size_t> faster_than_all_ours{};  ///< points with a smaller time than every point of ours
};

/// Compares other methods' points with ours. Points that are not finite, or whose time is not positive, are
/// ignored.
[[nodiscard]] Dominance CompareWithOurs(std::span<const RivalPoint> points);

}  // namespace osteon::studies
