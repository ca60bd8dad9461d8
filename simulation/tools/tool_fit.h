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

}  // namespace osteon::simulation
