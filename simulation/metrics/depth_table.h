#pragma once

#include <string>
#include <vector>

#include "simulation/cutting_engine.h"
#include "simulation/metrics/accuracy.h"
#include "simulation/metrics/depth_scenes.h"

namespace osteon::simulation {

/// One way to represent and to carve a bone.
struct DepthMethod {
  std::string name;
  std::vector<Ball> balls;
  SplitParams split;
};

/// What a method has left of a scene, and how exact that is.
struct DepthRow {
  std::string scene, method;
  std::size_t balls{0};     ///< of the uncut packing
  std::size_t live{0};      ///< after the cut
  std::size_t touching{0};  ///< of these, those that touch the swept volume
  std::size_t blocks{0};    ///< of the pool, in use at a time at most
  std::uint64_t refused{0};
  double overlap_m{0.0};   ///< deepest overlap of a live ball with the swept volume, exact
  CutAccuracy accuracy{};  ///< probes of the tool's radius, half of it, and 1 mm
};

/// Carves a packing along the scene's path, in steps, by pass 3 alone: what is measured is removal.
/// @returns the live balls.
[[nodiscard]] std::vector<Ball> CarveAlong(const DepthScene& scene, const std::vector<Pose>& path,
                                           const DepthMethod& method, DepthRow& row);

/// @param step_m  of the path;  @param params  its probes are replaced by the scene's
[[nodiscard]] DepthRow MeasureDepth(const DepthScene& scene, const DepthMethod& method, double step_m,
                                    const AccuracyParams& params);

/// What osteon recommends for each scene: `split` on a graded packing for a tool not much larger than the
/// balls, heavy overlap without it for a reamer.
[[nodiscard]] DepthMethod RecommendedMethod(const DepthScene& scene);

/// The paper's: disjoint balls, each as large as fits up to the cap, that shrink.
[[nodiscard]] DepthMethod DisjointMethod(const DepthScene& scene, std::size_t count,
                                         double greatest_radius_m);

}  // namespace osteon::simulation
