#pragma once

#include <memory>
#include <string>
#include <vector>

#include "simulation/engine/cutting_engine.h"
#include "simulation/fidelity/accuracy.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/solids/solid.h"
#include "simulation/tools/tool.h"

// Two cuts whose exact results are known, and the accuracy with which packings of balls reproduce them: an
// oracle of ball removal. The accuracy is exact up to the sampling of CutAccuracy.

namespace osteon::simulation {

/// A cut with a known exact result, to measure removal. All coordinates are in G; the tool's feed points
/// down.
struct DepthScene {
  std::string name;
  std::unique_ptr<Solid> solid;
  std::unique_ptr<CutZone> zone;  ///< region that is packed finely: around the cut, of any shape
  Tool tool;
  std::vector<Vector3> corners_m;  ///< corners of the tool centre's polyline

  /// Poses along the polyline, at most `step_m` apart.
  [[nodiscard]] std::vector<Pose> Path(double step_m) const;
};

/// A cube of 20 mm with its top face at z = 0; a ball of radius 5 mm plunges 5 mm deep and then moves 6 mm
/// sideways. The tool is small: about as large as the bone's balls.
[[nodiscard]] DepthScene MakeBlockScene();

/// Half a spherical shell with radii of 25 and 33 mm; a ball of radius 25 mm cuts 3 mm deep, like a reamer in
/// its cup.
[[nodiscard]] DepthScene MakeCupScene();

/// One way to represent and carve a bone.
struct DepthMethod {
  std::string name;
  std::vector<Ball> balls;
  SplitParams split;
};

/// A method's result in a scene, and the accuracy of its cut.
struct DepthRow {
  std::string scene, method;
  std::size_t balls{0};      ///< balls of the uncut packing
  std::size_t live{0};       ///< remaining balls after the cut
  std::size_t touching{0};   ///< remaining balls that touch the swept volume
  std::size_t blocks{0};     ///< most blocks of the pool in use at a time
  std::uint64_t refused{0};  ///< requests for a block when none was free (BallRemoval::refused)
  double overlap_m{0.0};     ///< deepest overlap of a remaining ball with the swept volume, exact
  CutAccuracy accuracy{};    ///< its probes have the tool's radius, half of this, and 1 mm
};

/// Carves a packing along the scene's path, in steps. Only the removal of an engine's frame runs. Fills the
/// row's `blocks` and `refused`.
/// @returns the remaining balls.
[[nodiscard]] std::vector<Ball> CarveAlong(const DepthScene& scene, const std::vector<Pose>& path,
                                           const DepthMethod& method, DepthRow& row);

/// Carves a packing and measures the result.
/// @param step_m  distance between the path's poses
/// @param params  of MeasureCut; the scene's tool sets the radii of its probes
[[nodiscard]] DepthRow MeasureDepth(const DepthScene& scene, const DepthMethod& method, double step_m,
                                    const AccuracyParams& params);

/// The recommended packing for each scene: `split` on a graded packing for a tool not much larger than the
/// balls, heavy overlap without splitting for a reamer.
[[nodiscard]] DepthMethod RecommendedMethod(const DepthScene& scene);

/// The paper's packing: disjoint balls, each as large as fits, up to max_radius_m. A cut shrinks them.
[[nodiscard]] DepthMethod DisjointMethod(const DepthScene& scene, std::size_t count, double max_radius_m);

}  // namespace osteon::simulation
