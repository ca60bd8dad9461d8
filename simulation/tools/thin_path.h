#pragma once

#include <utility>
#include <vector>

namespace osteon::simulation {

/// Removes points of a path while the rest stays within a tolerance of it; both ends stay.
/// @param distance  distance(p, a, b) returns the distance of the point p from the chord from a to b Source:
/// Douglas and Peucker, 1973; with an explicit stack, since a path may have 100 000 points.
template <class Point, class Distance>
[[nodiscard]] std::vector<Point> ThinPath(const std::vector<Point>& path, double tolerance,
                                          Distance distance) {
  if (path.size() < 3) return path;
  std::vector<char> keep(path.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> stack{{0, path.size() - 1}};
  while (!stack.empty()) {
    const auto [first, last] = stack.back();
    stack.pop_back();
    // Keep the point that is farthest from the chord, if it is farther than the tolerance, and examine both
    // halves.
    double max_distance = tolerance;
    std::size_t farthest_index = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance_to_chord = distance(path[i], path[first], path[last]);
      if (distance_to_chord > max_distance) {
        max_distance = distance_to_chord;
        farthest_index = i;
      }
    }
    if (farthest_index == 0) continue;
    keep[farthest_index] = 1;
    stack.emplace_back(first, farthest_index);
    stack.emplace_back(farthest_index, last);
  }
  std::vector<Point> thin;
  for (std::size_t i = 0; i < path.size(); ++i)
    if (keep[i]) thin.push_back(path[i]);
  return thin;
}

}  // namespace osteon::simulation
