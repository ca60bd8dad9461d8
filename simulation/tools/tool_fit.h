#pragma once

#include <span>
#include <vector>

#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

namespace osteon::simulation {

/// A point of a tool's exact surface, in T.
struct SurfaceSample {
  Vector3 p_m{Vector3::Zero()};
  Vector3 normal{Vector3::UnitZ()};  ///< unit, outwards
  double gap_m{1e-4};                ///< accepted gap between this point and the union of the balls
  bool cutting{true};
  bool edge{false};  ///< on an edge; the normal is the mean of both sides'
};

struct ToolFitParams {
  std::size_t max_count{64};  ///< most balls of the tool, including those it begins with
  double min_radius_m{10e-6};
};

struct ToolFit {
  std::vector<ToolBall> balls;  ///< cutting ones first, each kind from the apex back
  double worst_ratio{0.0};      ///< largest gap over accepted gap; above 1 where the balls did not suffice
};

/// Fits few balls whose union matches a solid to within the samples' gaps.
///
/// Each sample has its largest ball: the one that touches the surface there from inside and stays within the
/// solid. On an edge this ball has no size, and the one that stays half the gap below the edge is used. From
/// the apex back, take the first sample whose gap is still too large. Among the largest balls that serve it,
/// the one that serves the most samples is added (along a row this is the shortest cover). This repeats until
/// all samples are served or the count is reached. Only balls of a sample's own kind serve it, so the border
/// between cutting and touching parts stays in place to within the gap.
///
/// @param first  balls that the tool begins with, such as an analytic head
/// The result depends on the arguments alone. Cost: about 10 distances for each sample; balls × samples.
[[nodiscard]] ToolFit FitTool(const Solid& solid, std::span<const SurfaceSample> samples,
                              const std::vector<ToolBall>& first, const ToolFitParams& params);

/// Deviation of a tool made of balls from its exact shape.
struct ToolQuality {
  std::size_t cutting_balls{0}, touching_balls{0};
  /// From points of the exact surface to the union of the balls of that kind, for points that are not inside
  /// it.
  double cutting_gap_mean_m{0.0}, cutting_gap_max_m{0.0};
  double touching_gap_mean_m{0.0}, touching_gap_max_m{0.0};
  double protrusion_max_m{0.0};  ///< largest distance of a ball out of the solid
  double worst_ratio{0.0};       ///< largest gap over the sample's accepted gap
};

[[nodiscard]] ToolQuality MeasureTool(const Tool& tool, const Solid& solid,
                                      std::span<const SurfaceSample> samples);

}  // namespace osteon::simulation
