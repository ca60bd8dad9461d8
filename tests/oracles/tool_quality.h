#pragma once

#include <algorithm>
#include <limits>
#include <span>

#include "simulation/tools/tool_fit.h"

// The deviation of a tool made of balls from its exact shape: an oracle of FitTool and of the functions that
// make burrs, drills and mesh tools. The deviation is exact at the sampled points.

namespace osteon::simulation {

/// Deviation of a tool made of balls from its exact shape.
struct ToolQuality {
  std::size_t cutting_balls{0}, touching_balls{0};
  /// Distance from points of the exact surface to the nearest ball of the same kind (cutting or touching); 0
  /// inside a ball.
  double cutting_gap_mean_m{0.0}, cutting_gap_max_m{0.0};
  double touching_gap_mean_m{0.0}, touching_gap_max_m{0.0};
  double protrusion_max_m{0.0};  ///< largest distance by which a ball protrudes from the solid
  double worst_ratio{0.0};       ///< largest ratio of a sample's gap to its accepted gap
};

[[nodiscard]] inline ToolQuality MeasureTool(const Tool& tool, const Solid& solid,
                                             std::span<const SurfaceSample> samples) {
  ToolQuality quality;
  for (const ToolBall& ball : tool.balls) {
    ++(ball.cutting ? quality.cutting_balls : quality.touching_balls);
    quality.protrusion_max_m =
        std::max(quality.protrusion_max_m, ball.radius_m + solid.SignedDistance(ball.center_m));
  }
  std::size_t cutting = 0, touching = 0;
  for (const SurfaceSample& sample : samples) {
    double gap = std::numeric_limits<double>::infinity();
    for (const ToolBall& ball : tool.balls)
      if (ball.cutting == sample.cutting)
        gap = std::min(gap, std::max(0.0, (sample.p_m - Vector3(ball.center_m)).norm() - ball.radius_m));
    ++(sample.cutting ? cutting : touching);
    double& mean = sample.cutting ? quality.cutting_gap_mean_m : quality.touching_gap_mean_m;
    double& max = sample.cutting ? quality.cutting_gap_max_m : quality.touching_gap_max_m;
    mean += gap;
    max = std::max(max, gap);
    quality.worst_ratio = std::max(quality.worst_ratio, gap / sample.gap_m);
  }
  if (cutting > 0) quality.cutting_gap_mean_m /= static_cast<double>(cutting);
  if (touching > 0) quality.touching_gap_mean_m /= static_cast<double>(touching);
  return quality;
}

}  // namespace osteon::simulation
