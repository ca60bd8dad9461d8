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

/// Finds at most one sample in each cell of a division of the surface, and the sample's ball. `samples` gives
/// the cells' sides. A ball is no larger than the cap at its centre; samples whose ball is smaller than
/// min_radius_m are left out.
///
/// A ball of radius r may miss its foot by 0.05 h²/r, h being the samples' spacing. This is less than the
/// gap's growth from one sample to the next. On a mesh, a ball that touches an edge exactly would have radius
/// 0; with this allowance, it is about the ball that touches the smooth surface which the mesh approximates.
/// No ball leaves the solid.
///
/// The samples are in the octree's order, which does not depend on the number of threads.
/// @throws std::invalid_argument if there would be more than 100 million samples.
[[nodiscard]] std::vector<TangentBall> FindTangentBalls(const Solid& solid, const CutZone& zone,
                                                        const PackingParams& params,
                                                        const GradeParams& samples);

}  // namespace osteon::simulation
