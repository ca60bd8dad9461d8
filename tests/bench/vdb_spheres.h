#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/bone/bone.h"
#include "simulation/mesh/triangle_mesh.h"

namespace osteon::bench {

/// The spheres of OpenVDB's fillWithSpheres, and wall times.
struct VdbSpheres {
  std::vector<simulation::Ball> balls;
  double level_set_s{0.0};  ///< time from the mesh to the level set
  double fill_s{0.0};
};

/// The library's version; empty if this executable was built without it.
[[nodiscard]] std::string VdbVersion();

/// Makes a level set with voxels of 0.5 mm, three to each side of the surface, then calls fillWithSpheres. No
/// sphere is smaller than 0.05 mm. There are 100 candidate centres for each sphere, but at least 100 000 and
/// at most a million, because the time grows with the product of centres and spheres.
/// @pre VdbVersion() is not empty.
[[nodiscard]] VdbSpheres FillWithVdb(const simulation::TriangleMesh& mesh, std::size_t count,
                                     bool overlapping);

}  // namespace osteon::bench
