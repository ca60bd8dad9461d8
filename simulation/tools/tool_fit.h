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
  bool edge{false};  ///< true: lies on an edge of the surface; the normal is the mean of both sides' normals
};

/// Limits of FitTool.
struct ToolFitParams {
  std::size_t max_count{64};  ///< largest number of balls, including those that the tool begins with
  double min_radius_m{10e-6};
};

/// Result of FitTool.
struct ToolFit {
  std::vector<ToolBall> balls;  ///< cutting balls first, then touching balls; each kind from the apex back
  /// Largest ratio of a gap to its accepted gap; above 1: the balls did not suffice
  double worst_ratio{0.0};
};

/// Fits few balls whose union matches a solid to within the samples' gaps.
///
/// A ball serves a sample if it leaves no more than the accepted gap there. Each sample has its largest ball:
/// the one that touches the surface there from inside and stays within the solid. On an edge this ball has no
/// size, and the ball that stays half the gap below the edge is used. The fit goes from the apex back, and
/// takes the first sample that no ball serves yet. Among the samples' largest balls that serve it, the fit
/// adds the one that serves the most unserved samples. This repeats until all samples are served, or
/// max_count is reached. Only a cutting ball serves a cutting sample, and only a touching ball a touching
/// one, so the border between the cutting and the touching part moves by at most the gap.
///
/// @param first  balls that the tool begins with, such as an analytic head
/// The result depends on the arguments alone. Cost: about 10 queries of the solid's distance for each sample,
/// and time proportional to balls × samples.
[[nodiscard]] ToolFit FitTool(const Solid& solid, std::span<const SurfaceSample> samples,
                              const std::vector<ToolBall>& first, const ToolFitParams& params);

}  // namespace osteon::simulation
