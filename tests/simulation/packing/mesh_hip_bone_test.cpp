#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

#include "simulation/bone/scenes.h"
#include "tests/simulation/bone/cup_bone.h"
#include "tests/simulation/packing/cover_index.h"

// Tests of a real hip bone's mesh of 50 000 triangles, and of its packing. They are skipped if
// OSTEON_DATA_DIR names no folder with anatomical meshes.

namespace osteon::simulation {
namespace {

/// The left hip bone with a cup in its acetabulum.
class HipBone : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("OSTEON_DATA_DIR");
    if (folder) path_ = std::filesystem::path(folder) / "hip_bone_left.obj";
    if (!folder || !std::filesystem::exists(path_)) GTEST_SKIP() << "no anatomical meshes";
  }
  std::filesystem::path path_;
  CutSite cup_{.center_m = Vector3(0.0088, -0.1319, 0.5179),
               .axis = Vector3(Vector3(-0.983, -0.175, 0.052).normalized()),
               .radius_m = 0.021};
};

TEST_F(HipBone, MeshIsOneClosedShellOfTheKnownVolume) {
  const auto loaded = LoadMesh(path_);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->mesh.triangles.size(), 50'000u);
  EXPECT_EQ(loaded->report.shells.size(), 1u);
  EXPECT_FALSE(loaded->report.flipped);
  EXPECT_NEAR(SignedVolume_m3(loaded->mesh) * 1e6, 588.7, 0.1);  // cm^3, the data's README
}

// Mean and 95th percentile of the gaps between the packing and the mesh's surface, up to 4 mm from the cup's
// zone.
TEST_F(HipBone, PackingFollowsTheCupWithinAFewHundredthsOfAMillimetre) {
  const auto bone = MakeBoneFromMesh(path_, cup_, {});
  ASSERT_TRUE(bone) << bone.error().message;
  EXPECT_GT(bone->balls.size(), 20'000u);
  EXPECT_LT(bone->balls.size(), 40'000u);
  EXPECT_GT(bone->points.size(), 60'000u);
  EXPECT_LT(bone->points.size(), 120'000u);
  const auto loaded = LoadMesh(path_);
  const TriangleMesh& mesh = loaded->mesh;
  const MeshSolid solid(mesh);
  const CupZone zone(bone->site);
  double volume = 0.0, protrusion = -1.0;
  for (const MassPoint& point : bone->points) volume += point.volume_m3;
  EXPECT_NEAR(volume, SignedVolume_m3(mesh), 0.005 * SignedVolume_m3(mesh));
  CoverIndex index(solid.Bounds(), 3e-3, 1e-3);
  for (const Ball& ball : bone->balls) {
    index.Insert(ball);
    protrusion = std::max(protrusion, solid.SignedDistance(ball.center_m) + ball.radius_m);
  }
  EXPECT_LE(protrusion, 1e-12);
  std::vector<double> gaps;
  double sum = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3 p = (mesh.vertices_m[t[0]] + mesh.vertices_m[t[1]] + mesh.vertices_m[t[2]]) / 3.0;
    if (zone.DepthAt(p) > 4e-3) continue;
    gaps.push_back(std::max(0.0, index.Gap(p)));
    sum += gaps.back();
  }
  std::sort(gaps.begin(), gaps.end());
  EXPECT_LE(sum / static_cast<double>(gaps.size()), 0.03e-3);
  EXPECT_LE(gaps[gaps.size() * 95 / 100], 0.075e-3);
  std::printf("hip bone: %zu balls, %zu points; cup gap mean %.4f, p95 %.4f mm\n", bone->balls.size(),
              bone->points.size(), sum / static_cast<double>(gaps.size()) * 1e3,
              gaps[gaps.size() * 95 / 100] * 1e3);
}

}  // namespace
}  // namespace osteon::simulation
