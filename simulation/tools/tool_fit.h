#pragma once

#include <span>
#include <vector>

#include "simulation/solids/solid.h"
#include "simulation/tool.h"

namespace osteon::simulation {

/// A point of a tool's exact surface, in T.
struct SurfaceSample {
  Vector3 p_m{Vector3::Zero()};
  Vector3 normal{Vector3::UnitZ()};  ///< unit, outwards
  double gap_m{1e-4};                ///< accepted between this point and the union of the balls
  bool cutting{true};
  bool edge{false};  ///< on an edge: the normal is the mean of both sides'
};

struct ToolFitParams {
  std::size_t greatest_count{64};  ///< of the tool's balls, those it begins with included
  double least_radius_m{10e-6};
};

struct ToolFit {
  std::vector<ToolBall> balls;  ///< cutting ones first, each kind from the apex back
  double worst_ratio{0.0};      ///< greatest gap over accepted gap; above 1 where the balls did not suffice
};

/// Few balls whose union fits a solid to within the samples' gaps.
///
/// Each sample has its largest ball: the one that touches the surface there from inside and leaves the solid
/// nowhere; on an edge, where that one has no size, the one that stays half the gap below it. From the apex
/// back, the first sample whose gap is still too large is served by that of those balls which serves the most
/// samples with it (along a row this is the shortest cover); until all are served or the count is reached. A
/// sample is served by balls of its own kind only, so that the border between what cuts and what only touches
/// stays where it is, to within the gap.
///
/// @param first  balls the tool begins with, such as an analytic head
/// The result depends on the arguments alone. Cost: some 10 distances for each sample; balls × samples.
[[nodiscard]] ToolFit FitTool(const Solid& solid, std::span<const SurfaceSample> samples,
                              const std::vector<ToolBall>& first, const ToolFitParams& params);

/// What a tool made of balls is off its exact shape.
struct ToolQuality {
  std::size_t cutting_balls{0}, touching_balls{0};
  /// From points of the exact surface to the union of the balls of that kind; where they are not inside it.
  double cutting_gap_mean_m{0.0}, cutting_gap_max_m{0.0};
  double touching_gap_mean_m{0.0}, touching_gap_max_m{0.0};
  double protrusion_max_m{0.0};  ///< of a ball out of the solid
  double worst_ratio{0.0};       ///< greatest gap over the sample's accepted gap
};

[[nodiscard]] ToolQuality MeasureTool(const Tool& tool, const Solid& solid,
                                      std::span<const SurfaceSample> samples);

}  // namespace osteon::simulation
