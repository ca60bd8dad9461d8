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

/// A point of ours, and the other methods' points with both a smaller time and a smaller error.
struct BeatenPoint {
  std::size_t ours{0};            ///< index of our point
  std::vector<std::size_t> by{};  ///< indices of the other methods' points
};

/// Compares other methods' points with ours. All values are indices of points, in the points' order.
///
///     error │   o   ours: o            a  ahead: within its time none of ours is as exact
///           │ f   a                    f  faster than every one of ours
///           │       o b                b  beats neither
///           │           o
///           └──────────────── time     Both smaller than every one of ours: left of all o and below them.
struct Dominance {
  bool ours_measured{false};                 ///< otherwise the rest is empty
  std::vector<std::size_t> beat_all_ours{};  ///< a smaller time and a smaller error than every one of ours
  std::vector<BeatenPoint> beaten{};         ///< those of ours that at least one other point beats in both
  /// Other methods' points for which no point of ours is at once as fast and as exact. Without those of
  /// `faster_than_all_ours`.
  std::vector<std::size_t> ahead{};
  std::vector<std::size_t> faster_than_all_ours{};  ///< points with a smaller time than every one of ours
};

/// Compares other methods' points with ours. Points that are not finite, or whose time is not positive, are
/// ignored.
[[nodiscard]] Dominance CompareWithOurs(std::span<const RivalPoint> points);

}  // namespace osteon::studies
