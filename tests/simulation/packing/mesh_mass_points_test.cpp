#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "simulation/packing/mass_points.h"
#include "simulation/solids/mass_properties.h"
#include "simulation/solids/mesh_solid.h"

// Compares the mass points of anatomical meshes with the meshes' closed forms of volume, mass and moments.
// The tests are skipped if OSTEON_DATA_DIR names no folder with anatomical meshes.

namespace osteon::simulation {
namespace {

class MeshMassPoints : public testing::TestWithParam<const char*> {};

// About 20 000 points, twice as coarse as the default, so that the test is fast.
TEST_P(MeshMassPoints, HaveTheMeshsVolumeMassAndCenterOfMass) {
  const char* folder = std::getenv("OSTEON_DATA_DIR");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : "") / GetParam();
  if (!folder || !std::filesystem::exists(path)) GTEST_SKIP() << "no anatomical meshes";
  const auto loaded = LoadMesh(path);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const MeshSolid solid(loaded->mesh);
  const double spacing = std::cbrt(SignedVolume_m3(loaded->mesh) / 20'000.0);
  const std::vector<MassPoint> points =
      BuildMassPoints(solid, EverywhereZone(), {.cells = {.finest_m = spacing, .coarser_from_m = {}}});
  const Material material{.name = "bone", .density_kg_per_m3 = 1000.0};
  const MassProperties exact = MeshMassProperties(loaded->mesh, 1000.0);
  const MassProperties sum = PointMassProperties(points, std::vector{material});
  std::printf("%s: %zu points, volume %+.3f %%, centre of mass off by %.4f mm\n", GetParam(), points.size(),
              100.0 * (sum.volume_m3 / exact.volume_m3 - 1.0),
              (sum.center_of_mass_m - exact.center_of_mass_m).norm() * 1e3);
  EXPECT_NEAR(sum.volume_m3, exact.volume_m3, 0.005 * exact.volume_m3);
  EXPECT_NEAR(sum.mass_kg, exact.mass_kg, 0.005 * exact.mass_kg);
  EXPECT_LE((sum.center_of_mass_m - exact.center_of_mass_m).norm(), 0.1e-3);
  EXPECT_LE((sum.inertia_kg_m2 - exact.inertia_kg_m2).norm(), 0.01 * exact.inertia_kg_m2.norm());
}

INSTANTIATE_TEST_SUITE_P(, MeshMassPoints, testing::Values("hip_bone_left.obj", "tooth_molar_with_pulp.obj"),
                         [](const auto& mesh) {
                           return std::string(mesh.param).substr(0, std::string(mesh.param).find('_'));
                         });

}  // namespace
}  // namespace osteon::simulation
