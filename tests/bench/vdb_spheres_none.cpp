// Replaces vdb_spheres.cpp in a build without OpenVDB.

#include <stdexcept>

#include "tests/bench/vdb_spheres.h"

namespace osteon::bench {

std::string VdbVersion() { return {}; }

VdbSpheres FillWithVdb(const simulation::TriangleMesh&, std::size_t, bool) {
  throw std::logic_error("built without OpenVDB");
}

}  // namespace osteon::bench
