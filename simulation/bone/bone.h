#pragma once

#include <string>
#include <vector>

#include "kinematics/spatial.h"
#include "simulation/bone/material.h"

namespace osteon::simulation {

/// One ball of a packing, in G. In an overlapping packing the union of the balls is the bone; in a disjoint
/// packing no balls overlap.
struct Ball {
  PlainVector3 center_m;
  double radius_m{0.0};
};

/// One point of the mass cloud, in G: it represents a volume `volume_m3` of `material` around it. Removed
/// volume and mass are sums over the points that a cutting surface has swept. They are not computed from the
/// balls, because balls overlap.
struct MassPoint {
  PlainVector3 p_m;
  double volume_m3{0.0};
  MaterialIndex material{0};
};

/// The site that is cut, in G: a hemispherical cup that is reamed, or the circle at which a drill or burr
/// enters.
struct CutSite {
  PlainVector3 center_m;
  PlainVector3 axis{Vector3::UnitZ()};  ///< unit vector out of the bone (+z of frame C)
  double radius_m{0.024};
};

/// A bone: balls for contact and shape, points for mass and material. Both are sorted along a space-filling
/// curve, so that neighbours in the list are neighbours in space.
struct Bone {
  std::string name;
  std::vector<Ball> balls;
  std::vector<MassPoint> points;
  std::vector<Material> materials;
  CutSite site;
};

}  // namespace osteon::simulation
