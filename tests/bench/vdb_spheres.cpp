#include "tests/bench/vdb_spheres.h"

#include <algorithm>
#include <chrono>

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/VolumeToSpheres.h>

// Fills a mesh with spheres by OpenVDB, in a build that has this library.

namespace osteon::bench {

std::string VdbVersion() { return OPENVDB_LIBRARY_VERSION_STRING; }

VdbSpheres FillWithVdb(const simulation::TriangleMesh& mesh, std::size_t count, bool overlapping) {
  constexpr double kVoxel_mm = 0.5, kMm = 1e3;
  constexpr float kBand_voxels = 3.0f, kMinRadius_voxels = 0.1f;
  // Bounds of the number of candidate centres. With too few candidates, coverage falls (10 000 disjoint
  // spheres in a hip bone: 0.776 with 1 M candidates, 0.717 with 100 k). Each candidate costs time for each
  // sphere.
  constexpr int kMinInstances = 100'000, kMaxInstances = 1'000'000;
  openvdb::initialize();
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::duration d) { return std::chrono::duration<double>(d).count(); };
  VdbSpheres result;

  const auto start = Clock::now();
  std::vector<openvdb::Vec3s> vertices;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vector3& v : mesh.vertices_m) vertices.emplace_back(kMm * v.x(), kMm * v.y(), kMm * v.z());
  for (const auto& [i, j, k] : mesh.triangles) triangles.emplace_back(i, j, k);
  const auto transform = openvdb::math::Transform::createLinearTransform(kVoxel_mm);
  const auto grid =
      openvdb::tools::meshToLevelSet<openvdb::FloatGrid>(*transform, vertices, triangles, kBand_voxels);
  const auto filled_from = Clock::now();
  result.level_set_s = seconds(filled_from - start);

  std::vector<openvdb::Vec4s> spheres;
  const int max_spheres = static_cast<int>(count);
  openvdb::tools::fillWithSpheres(*grid, spheres, openvdb::Vec2i(1, max_spheres), overlapping,
                                  kMinRadius_voxels, std::numeric_limits<float>::max(), 0.0f,
                                  std::clamp(100 * max_spheres, kMinInstances, kMaxInstances));
  result.fill_s = seconds(Clock::now() - filled_from);
  for (const openvdb::Vec4s& s : spheres)
    result.balls.push_back({.center_m = Vector3(s[0] / kMm, s[1] / kMm, s[2] / kMm), .radius_m = s[3] / kMm});
  return result;
}

}  // namespace osteon::bench
