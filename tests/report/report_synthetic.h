#pragma once

#include <vector>

#include "control/tick_record.h"
#include "simulation/bone/bone.h"
#include "simulation/engine/cutting_engine.h"
#include "simulation/engine/frame_record.h"
#include "simulation/tools/tool.h"

namespace osteon::report {

/// A small run made by hand, for tests of the report, without engine and servo loop.
struct SyntheticRun {
  simulation::Bone bone;
  simulation::Tool tool;
  simulation::CarvedState after;
  std::vector<control::TickRecord> ticks;
  std::vector<simulation::FrameRecord> frames;
  double cell_m{1e-3};  ///< spacing of the lattice of balls
};

/// Sizes of the block, the tool and its path, and the length of the run.
struct SyntheticParams {
  double cup_radius_m{0.012}, tool_radius_m{0.0125};
  Vector3 block_m{0.036, 0.036, 0.024};     ///< edges; the cup opens in the middle of the +z face
  double spacing_m{0.9e-3}, cap_m{0.8e-3};  ///< lattice of balls: radius = min(cap, distance to the surface)
  double point_spacing_m{0.6e-3};           ///< lattice of mass points
  double depth_m{2.0e-3};                   ///< depth of the tool's apex below the cup's floor
  double tilt_rad{0.0};                     ///< tilt of the tool while it circles after the feed
  int ticks{2000}, frames{1000};
};

/// Makes a block with a hemispherical cup of radius R around the origin that opens at z = 0: cartilage,
/// cortical plate and cancellous bone below the cup. The tool cuts it as Carve does: along a straight feed,
/// then tilted and circling.
[[nodiscard]] SyntheticRun MakeSyntheticRun(const SyntheticParams& params = {});

/// Returns the proxy's path from the run's frames, in the bone's frame G.
[[nodiscard]] std::vector<Pose> PathOf(const SyntheticRun& run, const Pose& X_WG = Pose::Identity());

/// Cuts balls as the cutting model does, with a sphere of radius r that moves from a to b. A ball that the
/// sweep overlaps by the depth p loses p/2 of its radius and moves away by p/2; at p >= 2 radii it is gone
/// (radius 0).
void Carve(std::vector<simulation::Ball>& balls, const Vector3& a, const Vector3& b, double radius_m);

/// Makes the carved state of these balls as an engine would: floats in mm, radius 0 for removed balls.
[[nodiscard]] simulation::CarvedState StateOf(const std::vector<simulation::Ball>& balls);

}  // namespace osteon::report
