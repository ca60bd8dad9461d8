#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "kinematics/spatial.h"
#include "simulation/bone/bone.h"
#include "simulation/solids/solid.h"

namespace osteon::procedure {

/// The space that a tool clears while its head moves in to the planned centre: a ball at the centre, and a
/// cylinder of the same radius from the centre out of the opening. A burr that is moved around the axis
/// clears this space about each point of a disc, which gives an opening with a flat floor and a rounded edge.
/// In G.
struct PlannedCavity {
  Vector3 centre_m{Vector3::Zero()};
  Vector3 axis{Vector3::UnitZ()};  ///< unit, out of the opening
  double radius_m{0.0};            ///< of the tool's head
  double around_m{0.0};            ///< radius of the disc about the axis in which the head's centre is moved

  /// Radius of the whole opening.
  [[nodiscard]] double opening_radius_m() const { return radius_m + around_m; }
  /// Signed distance to the cavity's surface; negative inside. Exact, with one exception: for around_m > 0,
  /// points within the disc or above it get -radius, although they may lie deeper inside.
  [[nodiscard]] double DistanceTo(const Vector3& p_m) const {
    const Vector3 d_m = p_m - centre_m;
    const double along_m = std::max(0.0, d_m.dot(axis));
    const Vector3 to_axis_m = d_m - along_m * axis;
    if (!(around_m > 0.0)) return to_axis_m.norm() - radius_m;
    const double below_m = to_axis_m.dot(axis);
    const double aside_m = std::max(0.0, (to_axis_m - below_m * axis).norm() - around_m);
    return std::hypot(aside_m, below_m) - radius_m;
  }
};

/// Volume of a solid's bone inside the cavity but outside the cavities of earlier tools [m³]. It is a sum
/// over cells of edge `cell_m`. If a surface passes through a cell, the share inside is estimated from the
/// surface's distance. With cells of R/50 the error is below 0.1 % on smooth solids.
/// @param cleared  cavities of earlier tools
[[nodiscard]] double BoneInCavity(const simulation::Solid& solid, const PlannedCavity& cavity, double cell_m,
                                  std::span<const PlannedCavity> cleared = {});

/// Thickness of the thinnest wall that the cavity leaves, measured as in a running scene
/// (simulation/bone/scene_events.h); nothing if no wall was found.
/// @param sample_spacing_m  spacing of the samples on the solid's surface
[[nodiscard]] std::optional<double> PlannedWall(const simulation::Solid& solid,
                                                const simulation::CutSite& site, const PlannedCavity& cavity,
                                                double sample_spacing_m);

}  // namespace osteon::procedure
