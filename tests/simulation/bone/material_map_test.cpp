#include "simulation/bone/material_map.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

// Tests of the look-up of the material at a place of a bone.

namespace osteon::simulation {
namespace {

// Oracle: material of the nearest point, by testing every point at the float position that the map stores.
MaterialIndex NearestOfAll(const Bone& bone, const Vector3& p_m) {
  double nearest_m = std::numeric_limits<double>::infinity();
  MaterialIndex material = 0;
  for (const MassPoint& point : bone.points) {
    const Vector3 at = Vector3(point.p_m).cast<float>().cast<double>();
    if ((at - p_m).norm() >= nearest_m) continue;
    nearest_m = (at - p_m).norm();
    material = point.material;
  }
  return material;
}

// Random points in a box, each with a random material.
Bone Cloud(int count, const Vector3& size_m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> along(-0.5, 0.5);
  Bone bone;
  bone.materials.resize(8);
  for (int i = 0; i < count; ++i) {
    const Vector3 share(along(random), along(random), along(random));
    bone.points.push_back({.p_m = Vector3(share.cwiseProduct(size_m)),
                           .volume_m3 = 1e-9,
                           .material = static_cast<MaterialIndex>(random() % 8)});
  }
  return bone;
}

TEST(MaterialMap, TellsTheMaterialOfTheNearestPoint) {
  struct Case {
    int count;
    Vector3 size_m;
  };
  // points in a block, in a plate, on a line, few points, and two points at one place
  for (const Case& c : {Case{3000, {0.05, 0.04, 0.06}}, Case{500, {0.1, 0.1, 0.0}},
                        Case{300, {0.2, 0.0, 0.0}}, Case{3, {0.1, 0.1, 0.1}}, Case{2, {0.0, 0.0, 0.0}}}) {
    const Bone bone = Cloud(c.count, c.size_m, 11);
    const MaterialMap map(bone);
    std::mt19937_64 random(12);
    std::uniform_real_distribution<double> along(-0.09, 0.09);  // places inside the cloud and far outside it
    for (int i = 0; i < 400; ++i) {
      const Vector3 p_m(along(random), along(random), along(random));
      ASSERT_EQ(map.At(p_m), NearestOfAll(bone, p_m)) << c.count << " points, look-up " << i;
    }
  }
}

TEST(MaterialMap, ReturnsTheOnlyMaterialAnywhereAndZeroWithoutPoints) {
  Bone bone = Cloud(10, {0.1, 0.1, 0.1}, 13);
  for (MassPoint& point : bone.points) point.material = 3;
  EXPECT_EQ(MaterialMap(bone).At(Vector3(1, 2, 3)), 3);
  EXPECT_EQ(MaterialMap(Bone{}).At(Vector3::Zero()), 0);
}

}  // namespace
}  // namespace osteon::simulation
