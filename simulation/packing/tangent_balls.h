#pragma once

#include <vector>

#include "simulation/packing/packing_builder.h"

namespace osteon::simulation {

/// A sample of the surface and the largest ball that touches the surface there from inside.
struct TangentBall {
  Vector3 foot_m;
  Ball ball;
  float tolerance_m{0.0f};  ///< largest gap that may remain at the foot
};

/// Finds at most one sample in each cell of a division of the surface with these sides, and the sample's
/// ball: no larger than the cap at its centre, no smaller than min_radius_m (smaller ones are left out).
///
/// A ball may miss its foot by 0.05 h²/r, h the samples' spacing; the gap grows by more than this
/// between one sample and the next. On a mesh, the ball that touches an edge has no radius; the allowance
/// then gives the ball of the smooth surface behind the mesh. No ball leaves the solid.
///
/// In the octree's order; the same for any number of threads.
/// @throws std::invalid_argument where there would be more than 100 million.
[[nodiscard]] std::vector<TangentBall> FindTangentBalls(const Solid& solid, const CutZone& zone,
                                                        const PackingParams& params,
                                                        const GradeParams& samples);

}  // namespace osteon::simulation
