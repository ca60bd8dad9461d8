#pragma once

#include <string>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/accuracy.h"
#include "simulation/fidelity/depth_scenes.h"

namespace osteon::simulation {

/// One way to represent and carve a bone.
struct DepthMethod {
  std::string name;
  std::vector<Ball> balls;
  SplitParams split;
};

/// A method's result in a scene, and the accuracy of its cut.
struct DepthRow {
  std::string scene, method;
  std::size_t balls{0};     ///< in the uncut packing
  std::size_t live{0};      ///< remaining balls after the cut
  std::size_t touching{0};  ///< remaining balls that touch the swept volume
  std::size_t blocks{0};    ///< most blocks of the pool in use at a time
  std::uint64_t refused{0};
  double overlap_m{0.0};   ///< deepest overlap of a remaining ball with the swept volume, exact
  CutAccuracy accuracy{};  ///< with probes of the tool's radius, half of it, and 1 mm
};

/// Carves a packing along the scene's path, in steps. Only pass 3 runs, because removal alone is measured.
/// @returns the remaining balls.
[[nodiscard]] std::vector<Ball> CarveAlong(const DepthScene& scene, const std::vector<Pose>& path,
                                           const DepthMethod& method, DepthRow& row);

/// Carves a packing and measures the result.
/// @param step_m  of the path;  @param params  its probes are replaced by the scene's
[[nodiscard]] DepthRow MeasureDepth(const DepthScene& scene, const DepthMethod& method, double step_m,
                                    const AccuracyParams& params);

/// The recommended packing for each scene: `split` on a graded packing for a tool not much larger than the
/// balls, heavy overlap without splitting for a reamer.
[[nodiscard]] DepthMethod RecommendedMethod(const DepthScene& scene);

/// The paper's packing: disjoint balls, each as large as fits up to the cap, that shrink.
[[nodiscard]] DepthMethod DisjointMethod(const DepthScene& scene, std::size_t count, double max_radius_m);

}  // namespace osteon::simulation
