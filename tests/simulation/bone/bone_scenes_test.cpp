#include "simulation/bone/scenes.h"

#include <stdexcept>

#include <gmock/gmock.h>

#include "tests/simulation/bone/cup_bone.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Tests of bones with a cup: the generated acetabulum, and meshes with a planned cup.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

/// Mesh of a block of 60 × 60 × 40 mm with a cup in its top: the lower half of a sphere of radius 20 mm about
/// the origin; +z points out of the cup.
TriangleMesh MakeCupBlock() {
  // A grid over the top face is projected down to the sphere inside the cup's rim. The block's sides go down
  // from the grid's border.
  const int n = 48;
  const double half = 0.03, radius = 0.02;
  TriangleMesh mesh;
  const auto height = [&](double x, double y) {
    const double rest = radius * radius - x * x - y * y;
    return rest > 0.0 ? -std::sqrt(rest) : 0.0;
  };
  const auto top = [&](int i, int j) { return static_cast<std::uint32_t>(i * (n + 1) + j); };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double x = half * (2.0 * i / n - 1.0), y = half * (2.0 * j / n - 1.0);
      mesh.vertices_m.emplace_back(x, y, height(x, y));
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({top(i, j), top(i + 1, j), top(i + 1, j + 1)});
      mesh.triangles.push_back({top(i, j), top(i + 1, j + 1), top(i, j + 1)});
    }
  std::vector<std::uint32_t> border;  // counter-clockwise from above
  for (int k = 0; k < n; ++k) border.push_back(top(k, 0));
  for (int k = 0; k < n; ++k) border.push_back(top(n, k));
  for (int k = n; k > 0; --k) border.push_back(top(k, n));
  for (int k = n; k > 0; --k) border.push_back(top(0, k));
  const auto low = static_cast<std::uint32_t>(mesh.vertices_m.size());  // first vertex of the bottom
  for (const std::uint32_t v : border) {
    const Vector3 above = mesh.vertices_m[v];
    mesh.vertices_m.emplace_back(above.x(), above.y(), -0.04);
  }
  mesh.vertices_m.emplace_back(0, 0, -0.04);
  const auto count = static_cast<std::uint32_t>(border.size());
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t next = (k + 1) % count;
    mesh.triangles.push_back({border[k], low + k, low + next});
    mesh.triangles.push_back({border[k], low + next, border[next]});
    mesh.triangles.push_back({low + next, low + k, low + count});
  }
  return mesh;
}

/// The cup of MakeCupBlock; its axis is deliberately not of unit length.
const CutSite kCup{.center_m = Vector3(0, 0, 0), .axis = Vector3(0, 0, 3), .radius_m = 0.02};

TEST(BoneScenes, AnAcetabulumHasBallsPointsAndTheThreeTissues) {
  const Bone bone = MakeAcetabulum({});
  EXPECT_EQ(bone.name, "acetabulum, cup 48 mm");
  EXPECT_EQ(bone.site.radius_m, 0.024);
  ASSERT_EQ(bone.materials.size(), 4u);
  EXPECT_EQ(bone.materials[kCortical].name, "cortical");
  std::array<int, 3> points{};
  for (const MassPoint& point : bone.points) ++points.at(point.material);
  for (const int count : points) EXPECT_GT(count, 5000);  // marrow, the fourth material, has no points
  EXPECT_GT(bone.balls.size(), 28'000u);
}

TEST(BoneScenes, MaterialsNeedTheExpectedNamesOrderAndPositiveFigures) {
  const auto message = [](std::vector<Material> materials) -> std::string {
    AcetabulumParams params;
    params.materials = std::move(materials);
    try {
      return MakeAcetabulum(params).name;
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  std::vector<Material> materials = DefaultBoneMaterials();
  std::swap(materials[0], materials[1]);
  EXPECT_EQ(message(materials), "bone: material 0: found name 'cortical', accepted 'cartilage'");
  materials = DefaultBoneMaterials();
  materials[2].density_kg_per_m3 = 0.0;
  EXPECT_EQ(message(materials), "bone: cancellous: density_kg_per_m3: found 0, accepted > 0");
  materials.resize(2);
  EXPECT_THAT(message(materials), HasSubstr("found 2, accepted at least 3"));
}

TEST(BoneScenes, BoneFromAMeshFillsTheMeshAndStaysInsideIt) {
  const TriangleMesh mesh = MakeCupBlock();
  const TemporaryFile file(".obj", ObjText(mesh));
  const auto bone = MakeBoneFromMesh(file.path(), kCup, {});
  ASSERT_TRUE(bone) << bone.error().message;
  EXPECT_NEAR(Vector3(bone->site.axis).norm(), 1.0, 1e-15);
  const double exact = SignedVolume_m3(mesh);
  double volume = 0.0;
  for (const MassPoint& point : bone->points) volume += point.volume_m3;
  EXPECT_NEAR(volume, exact, 0.005 * exact);
  for (const Ball& ball : bone->balls) {
    const Vector3 c = ball.center_m;
    // 1 nm: the file has millimetres with six decimals
    ASSERT_LE(c.cwiseAbs().head<2>().maxCoeff() + ball.radius_m, 0.03 + 1e-9);
    ASSERT_GE(c.z() - ball.radius_m, -0.04 - 1e-9);
    ASSERT_LE(c.z() + ball.radius_m, 1e-9);
  }
}

TEST(BoneScenes, ACupThatTheMeshDoesNotHaveIsRefusedWithTheFinding) {
  const TemporaryFile file(".obj", ObjText(MakeCupBlock()));
  const auto refusal = [&](CutSite cup) {
    const auto bone = MakeBoneFromMesh(file.path(), cup, {});
    EXPECT_FALSE(bone);
    if (bone) return std::string();
    EXPECT_EQ(bone.error().kind, MeshErrorKind::kCupOffMesh);
    return bone.error().message;
  };
  CutSite away = kCup;
  away.center_m = Vector3(0.2, 0, 0);
  EXPECT_THAT(refusal(away), HasSubstr("in 0 % of its lower half, accepted 25 % and more"));
  CutSite upside_down = kCup;
  upside_down.axis = Vector3(0, 0, -1);
  EXPECT_THAT(refusal(upside_down), HasSubstr("the axis points out of the opening"));
  CutSite buried = kCup;
  buried.center_m = Vector3(0, 0, -0.0255);
  buried.radius_m = 0.008;
  EXPECT_FALSE(refusal(buried).empty());
}

// The top of a ball is a site where a drill may enter, but no cup for a reamer's scene.
TEST(BoneScenes, AConvexSiteIsRefusedAsACup) {
  const TemporaryFile file(".obj", ObjText(MakeIcosphere({0, 0, 0}, 0.024, 3)));
  const CutSite on_top{.center_m = Vector3(0, 0, 0.024), .axis = Vector3(0, 0, 1), .radius_m = 0.025};
  SceneParams scene;
  scene.material_names = {"bone"};
  scene.materials = {DefaultBoneMaterials().front()};
  scene.zone.kind = ZoneParams::Kind::kCup;
  const auto refused = LoadSceneSolid(file.path(), 1.0, on_top, scene);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, MeshErrorKind::kCupOffMesh);
  EXPECT_THAT(refused.error().message,
              HasSubstr("found a convex place (the surface falls away from 100 % of the cup's rim)"));
  EXPECT_THAT(refused.error().message, HasSubstr("such as femoral_head"));
  scene.zone = {
      .kind = ZoneParams::Kind::kPath, .radius_m = 0.002, .path_C_m = {{0, 0, 0.005}, {0, 0, -0.01}}};
  EXPECT_TRUE(LoadSceneSolid(file.path(), 1.0, on_top, scene)) << "for a scene that drills it is a site";
  // a flat face is accepted as a cup too
  const TemporaryFile block(".obj", ObjText(MakeBox({-0.03, -0.03, -0.03}, {0.03, 0.03, 0.024})));
  scene.zone.kind = ZoneParams::Kind::kCup;
  EXPECT_TRUE(LoadSceneSolid(block.path(), 1.0, on_top, scene));
}

TEST(BoneScenes, AnInvalidCupOrThicknessThrows) {
  CutSite cup = kCup;
  cup.radius_m = -0.02;
  EXPECT_THROW((void)MakeBoneFromMesh("bone.obj", cup, {}), std::invalid_argument);
  cup = kCup;
  cup.axis = Vector3(0, 0, 0);
  EXPECT_THROW((void)MakeBoneFromMesh("bone.obj", cup, {}), std::invalid_argument);
  EXPECT_THROW((void)MakeBoneFromMesh("bone.obj", kCup, {.cortical_m = -1.0}), std::invalid_argument);
}

TEST(BoneScenes, AMissingMeshFileIsAMeshError) {
  const auto bone = MakeBoneFromMesh("/nowhere/bone.obj", kCup, {});
  ASSERT_FALSE(bone);
  EXPECT_EQ(bone.error().kind, MeshErrorKind::kMissing);
}

}  // namespace
}  // namespace osteon::simulation
