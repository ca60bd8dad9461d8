#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "simulation/packing/ball_forest.h"

// Exact distances of mass points to their nearest neighbours. They show how evenly a bone's mass points are
// distributed.

namespace osteon::simulation {

/// Distance of points to their nearest neighbours over the mean spacing. A point's spacing is the cube root
/// of the volume that it stands for; a pair uses the larger of its two spacings.
struct NeighborDistances {
  double min_over_spacing{0.0};
  double mean_over_spacing{0.0};  ///< independent points 0.554; face-centred lattice 1.122
  /// Share of the points whose distance over spacing is within [i, i + 1) / 20.
  std::vector<double> histogram;
};

/// Measures the neighbour distances; `spacing_m[i]` is the spacing at point i.
/// @throws std::invalid_argument if the lengths differ or a spacing is not finite and positive.
[[nodiscard]] inline NeighborDistances MeasureNeighborDistances(std::span<const Vector3> points_m,
                                                                std::span<const double> spacing_m) {
  if (points_m.size() != spacing_m.size())
    throw std::invalid_argument("neighbour distances: accepted one spacing a point");
  std::vector<Ball> balls(points_m.size());
  for (std::size_t i = 0; i < balls.size(); ++i) {
    if (!points_m[i].allFinite() || !(spacing_m[i] > 0.0) || !std::isfinite(spacing_m[i]))
      throw std::invalid_argument("neighbour distances: accepted finite points and spacings above 0");
    balls[i] = {.center_m = points_m[i], .radius_m = spacing_m[i]};
  }
  NeighborDistances result;
  if (balls.size() < 2) return result;
  constexpr double kBinsPerSpacing = 20.0;
  const BallForest forest(balls);
  const double share = 1.0 / static_cast<double>(balls.size());
  result.min_over_spacing = forest.Separation(balls.front());
  for (const Ball& ball : balls) {
    const double separation = forest.Separation(ball);
    const auto bin = static_cast<std::size_t>(separation * kBinsPerSpacing);
    if (bin >= result.histogram.size()) result.histogram.resize(bin + 1, 0.0);
    result.histogram[bin] += share;
    result.mean_over_spacing += share * separation;
    result.min_over_spacing = std::min(result.min_over_spacing, separation);
  }
  return result;
}

}  // namespace osteon::simulation
