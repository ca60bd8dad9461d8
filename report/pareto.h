#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace osteon::report {

/// A point with two costs; smaller costs are better.
struct CostPoint {
  double x{0.0}, y{0.0};
};

/// Says for each point whether it is on the Pareto front: no other point is at least as good in both costs
/// and better in one. Points that are not finite are not on the front.
[[nodiscard]] inline std::vector<bool> OnParetoFront(std::span<const CostPoint> points) {
  const auto finite = [](const CostPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y); };
  std::vector<bool> front(points.size(), false);
  for (std::size_t i = 0; i < points.size(); ++i) {
    front[i] = finite(points[i]);
    for (const CostPoint& other : points)
      if (finite(other) && other.x <= points[i].x && other.y <= points[i].y &&
          (other.x < points[i].x || other.y < points[i].y))
        front[i] = false;
  }
  return front;
}

}  // namespace osteon::report
