#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "simulation/bone.h"
#include "simulation/mesh/triangle_mesh.h"

namespace osteon::bench {

/// Spheres by OpenVDB's fillWithSpheres, and what they cost in wall time.
struct VdbSpheres {
  std::vector<simulation::Ball> balls;
  double level_set_s{0.0};  ///< mesh to level set
  double fill_s{0.0};
};

/// The library's version; empty where this executable was built without it.
[[nodiscard]] std::string VdbVersion();

/// A level set of .5 mm voxels, three to each side of the surface, then fillWithSpheres: no sphere below .05
/// mm, and as many points to choose centres from as the count, 100 000 at least (its cost is their product).
/// @pre VdbVersion() is not empty.
[[nodiscard]] VdbSpheres FillWithVdb(const simulation::TriangleMesh& mesh, std::size_t count,
                                     bool overlapping);

}  // namespace osteon::bench
