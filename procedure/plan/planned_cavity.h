#pragma once

#include <algorithm>
#include <optional>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::procedure {

/// What a reamer clears on its way in to a centre: the ball at the centre, and the cylinder of the same
/// radius from there out of the opening. In G.
struct PlannedCavity {
  Vector3 centre_m{Vector3::Zero()};
  Vector3 axis{Vector3::UnitZ()};  ///< unit, out of the opening
  double radius_m{0.0};

  /// Signed distance to the cavity's surface; negative inside. Exact.
  [[nodiscard]] double DistanceTo(const Vector3& p_m) const {
    const Vector3 d_m = p_m - centre_m;
    const double along_m = std::max(0.0, d_m.dot(axis));
    return (d_m - along_m * axis).norm() - radius_m;
  }
};

/// Volume of a solid's bone inside the cavity [m³]: cells of edge `cell_m`, those that a surface passes
/// through by the surface's distance. With cells of R/50 the error is below 0.1 % on smooth solids.
[[nodiscard]] double BoneInCavity(const simulation::Solid& solid, const PlannedCavity& cavity, double cell_m);

/// Thinnest wall that the cavity leaves, by the scene's watch (simulation/bone/scene_events.h); nothing where
/// no wall was seen.
/// @param sample_spacing_m  of the solid's surface
[[nodiscard]] std::optional<double> PlannedWall(const simulation::Solid& solid,
                                                const simulation::CutSite& site, const PlannedCavity& cavity,
                                                double sample_spacing_m);

}  // namespace osteon::procedure
