#include "simulation/bone/scenes.h"

#include <cstdlib>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "simulation/solids/cup_frame.h"
#include "tests/oracles/depth_table.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Tests of scenes: their solid, site, cut zone and materials, from generated shapes and from meshes.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

// Materials with these names and default figures.
std::vector<Material> Named(const std::vector<std::string>& names) {
  std::vector<Material> materials;
  for (const std::string& name : names) materials.emplace_back().name = name;
  return materials;
}

/// A coarse plate of 20 × 20 × 2 mm, with a hole to be drilled through it.
SceneParams Plate() {
  SceneParams scene;
  scene.shape = BlockShape{.width_m = 0.020, .depth_m = 0.020, .height_m = 0.002, .layers = {}};
  scene.site = {.x_m = 0.003, .y_m = -0.001, .radius_m = 0.002};
  scene.zone = {
      .kind = ZoneParams::Kind::kPath, .radius_m = 0.002, .path_C_m = {{0, 0, 0.003}, {0, 0, -0.005}}};
  scene.material_names = {"cortical"};
  scene.materials = Named(scene.material_names);
  scene.mesh_tissue.solid.core = 0;
  scene.packing.lattice = {.finest_m = 0.5e-3, .coarser_from_m = {2e-3, 5e-3}};
  scene.packing.cup_radius_cap_m = 0.6e-3;
  scene.packing.cup_depth_m = 1e-3;
  scene.packing.samples = {.finest_m = 0.2e-3, .coarser_from_m = {2e-3, 5e-3}};
  scene.points.cells = {.finest_m = 0.3e-3, .coarser_from_m = {2e-3, 5e-3}};
  return scene;
}

// The message of the exception that the call throws, or "accepted".
template <typename Call>
std::string Refusal(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Scenes, TheSiteIsProjectedOntoTheSurfaceBelowItsXAndY) {
  const SceneSolid plate = MakeSceneSolid(Plate());
  EXPECT_LT((Vector3(plate.site.center_m) - Vector3(0.003, -0.001, 0.0)).norm(), 1e-8);
  EXPECT_EQ(Vector3(plate.site.axis), Vector3(Vector3::UnitZ()));
  EXPECT_EQ(plate.site.radius_m, 0.002);
  EXPECT_EQ(plate.name, "block, 20 × 20 × 2 mm");

  SceneParams scene;
  scene.shape = MolarShape{};
  scene.site = {.x_m = 0.0005, .y_m = 0.001, .radius_m = 0.00175};
  const SceneSolid molar = MakeSceneSolid(scene);
  EXPECT_LT(std::abs(molar.solid->SignedDistance(molar.site.center_m)), 1e-8);
  EXPECT_GT(Vector3(molar.site.center_m).z(), 0.004) << "on the crown, not on its underside";

  scene.shape = AcetabulumShape{};
  EXPECT_EQ(MakeSceneSolid(scene).site.radius_m, 0.024) << "its cup is its site";
}

TEST(Scenes, ASiteBesideTheSolidIsRefused) {
  SceneParams scene = Plate();
  scene.site.x_m = 0.5;
  EXPECT_THAT(
      Refusal([&] { (void)MakeSceneSolid(scene); }),
      HasSubstr("site: found (500, -1) mm, accepted a place above the solid, which spans (-10, -10) to "
                "(10, 10) mm"));
  scene = Plate();
  scene.site.radius_m = 0.0;
  EXPECT_THAT(Refusal([&] { (void)MakeSceneSolid(scene); }), HasSubstr("site: radius: found 0 mm"));
}

TEST(Scenes, ZonesAreRelativeToTheSite) {
  const BoxSolid solid(Vector3(-0.05, -0.05, -0.05), Vector3(0.05, 0.05, 0.05));
  // a site on the side of the box, looking along -x
  const CutSite site{.center_m = Vector3(-0.05, 0.01, 0.02), .axis = Vector3(-1, 0, 0), .radius_m = 0.003};
  const auto path =
      MakeZone({.kind = ZoneParams::Kind::kPath, .radius_m = 0.002, .path_C_m = {{0, 0, 0}, {0, 0, -0.01}}},
               site, solid);
  EXPECT_NEAR(path->DepthAt({-0.045, 0.01, 0.02}), -0.002, 1e-12) << "on the path's axis";
  EXPECT_NEAR(path->DepthAt({-0.045, 0.015, 0.02}), 0.003, 1e-12);
  EXPECT_NEAR(path->DepthAt({-0.030, 0.01, 0.02}), 0.008, 1e-12) << "beyond the path's end";
  const auto cup = MakeZone({}, site, solid);
  EXPECT_NEAR(cup->DepthAt({-0.045, 0.01, 0.02}), 0.002, 1e-12);
  const auto surface =
      MakeZone({.kind = ZoneParams::Kind::kSurface, .radius_m = 0.004, .path_C_m = {}}, site, solid);
  EXPECT_NEAR(surface->DepthAt({-0.049, 0.01, 0.02}), 0.001, 1e-12);
  EXPECT_NEAR(surface->DepthAt({-0.049, 0.03, 0.02}), std::hypot(0.001, 0.020) - 0.004, 1e-12);
  const auto everywhere =
      MakeZone({.kind = ZoneParams::Kind::kEverywhere, .radius_m = 0.0, .path_C_m = {}}, site, solid);
  EXPECT_EQ(everywhere->DepthAt({0, 0, 0}), 0.0);
}

TEST(Scenes, PackedBallsAreFineAtTheSiteAndStayInTheSolid) {
  const SceneParams scene = Plate();
  const SceneSolid solid = MakeSceneSolid(scene);
  const Bone bone = PackScene(solid, scene);
  const auto zone = MakeZone(scene.zone, solid.site, *solid.solid);
  int near = 0, far = 0;
  for (const Ball& ball : bone.balls) {
    const Vector3 c = ball.center_m;
    ASSERT_LE(ball.radius_m, -solid.solid->SignedDistance(c) + 1e-12);
    if (zone->DepthAt(c) - ball.radius_m < scene.packing.cup_depth_m) {
      ASSERT_LE(ball.radius_m, scene.packing.cup_radius_cap_m + 1e-12);
    }
    ++(zone->DepthAt(c) < 1e-3 ? near : far);
  }
  // a disc of 3 mm around the site has a sixteenth of the plate's area
  EXPECT_GT(near, far / 5);
  double volume = 0.0;
  for (const MassPoint& point : bone.points) volume += point.volume_m3;
  EXPECT_NEAR(volume, 0.8e-6, 0.005 * 0.8e-6);
  EXPECT_EQ(Vector3(bone.site.center_m), Vector3(solid.site.center_m));
  EXPECT_EQ(bone.materials.size(), 1u);
}

TEST(Scenes, TheSameParametersGiveTheSameBone) {
  SceneParams scene = Plate();
  scene.packing.threads = 1;
  const Bone a = PackScene(MakeSceneSolid(scene), scene);
  scene.packing.threads = 3;
  const Bone b = PackScene(MakeSceneSolid(scene), scene);
  ASSERT_EQ(a.balls.size(), b.balls.size());
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.balls.size(); ++i) {
    ASSERT_EQ(Vector3(a.balls[i].center_m), Vector3(b.balls[i].center_m));
    ASSERT_EQ(a.balls[i].radius_m, b.balls[i].radius_m);
  }
  for (std::size_t i = 0; i < a.points.size(); ++i)
    ASSERT_EQ(Vector3(a.points[i].p_m), Vector3(b.points[i].p_m));
}

// A burr moves into a block by its own radius, then along the face. One packing has large balls, which the
// engine splits at the cut; the other is fine from the start. The first must have less than half the balls
// and less than half the depth error of the second.
TEST(Scenes, SplittingNeedsFewerBallsAndCutsMoreAccurately) {
  SceneParams scene = Plate();
  scene.shape = BlockShape{.width_m = 0.012, .depth_m = 0.012, .height_m = 0.006, .layers = {}};
  scene.site = {.x_m = 0.0, .y_m = 0.0, .radius_m = 0.002};
  scene.zone = {
      .kind = ZoneParams::Kind::kPath, .radius_m = 0.002, .path_C_m = {{0, 0, 0.002}, {0, 0, -0.001}}};
  const SceneSolid made = MakeSceneSolid(scene);
  DepthScene cut;
  cut.name = "burr";
  cut.solid = std::make_unique<BoxSolid>(std::get<BlockShape>(scene.shape));
  cut.zone = MakeZone(scene.zone, made.site, *made.solid);
  cut.tool.balls = {{.center_m = Vector3(0, 0, -1e-3), .radius_m = 1e-3, .cutting = true}};
  const Vector3 top = made.site.center_m;
  cut.corners_m = {top + Vector3(-0.8e-3, 0, 1.1e-3), top + Vector3(-0.8e-3, 0, 0),
                   top + Vector3(0.8e-3, 0, 0)};
  const auto measure = [&](bool split) {
    const DepthMethod method{.name = "",
                             .balls = PackScene(made, scene, split).balls,
                             .split = {.on = split, .min_radius_m = 0.13e-3}};
    return MeasureDepth(cut, method, 0.05e-3, {.surface_cells = 8000});
  };
  const DepthRow whole = measure(false), split = measure(true);
  EXPECT_LT(2 * split.balls, whole.balls);
  EXPECT_GT(split.blocks, 20u);
  EXPECT_EQ(split.refused, 0u);
  EXPECT_LT(split.accuracy.depth_error_m, 0.5 * whole.accuracy.depth_error_m);
  EXPECT_LT(split.overlap_m, 1e-12);
  std::printf("whole: %zu balls, %zu left, %.4f mm; split: %zu balls, %zu left, %.4f mm\n", whole.balls,
              whole.live, 1e3 * whole.accuracy.depth_error_m, split.balls, split.live,
              1e3 * split.accuracy.depth_error_m);
}

TEST(Scenes, MaterialsMustMatchTheNamesOfTheScene) {
  SceneParams scene = Plate();
  const SceneSolid solid = MakeSceneSolid(scene);
  scene.materials = Named({"foam"});
  EXPECT_EQ(Refusal([&] { (void)PackScene(solid, scene); }),
            "bone: material 0: found name 'foam', accepted 'cortical'");
  scene.materials.clear();
  EXPECT_EQ(Refusal([&] { (void)PackScene(solid, scene); }),
            "bone: materials: found 0, accepted exactly 1: cortical");
  EXPECT_EQ(MaterialNames(MolarShape{}), (std::vector<std::string>{"enamel", "dentine", "pulp"}));
  EXPECT_EQ(MaterialNames(FemurShape{}), (std::vector<std::string>{"cortical", "cancellous", "marrow"}));
}

// ---------------------------------------------------------------- scenes whose solid is a mesh file

/// The .obj text of a simple tooth in units of `unit_mm`: object "Crown", a box, with object "Nerve", a ball,
/// in it.
std::string ToothObjText(double unit_mm) {
  const TriangleMesh outer = MakeBox({-0.005, -0.004, 0.0}, {0.005, 0.004, 0.010}),
                     inner = MakeIcosphere({0, 0, 0.005}, 0.002, 3);
  std::string text;
  std::size_t first = 1;
  for (const auto& [name, mesh] : {std::pair{"Nerve", &inner}, std::pair{"Crown", &outer}}) {
    text += std::string("o ") + name + "\n";
    for (const Vector3& v : mesh->vertices_m)
      text +=
          fmt::format("v {} {} {}\n", v.x() * 1e3 / unit_mm, v.y() * 1e3 / unit_mm, v.z() * 1e3 / unit_mm);
    for (const auto& t : mesh->triangles)
      text += fmt::format("f {} {} {}\n", first + t[0], first + t[1], first + t[2]);
    first += mesh->vertices_m.size();
  }
  return text;
}

/// Scene of that tooth: 0.5 mm of enamel (0) over dentine (1), and pulp (2) in the region "nerve".
SceneParams Tooth() {
  SceneParams scene = Plate();
  scene.material_names = {"enamel", "dentine", "pulp"};
  scene.materials = Named(scene.material_names);
  scene.mesh_tissue.solid.layers = {{.material = 0, .thickness_m = 0.0005}};
  scene.mesh_tissue.solid.core = 1;
  scene.mesh_tissue.regions = {{.name = "nerve", .tissue = {.layers = {}, .core = 2, .image = {}}}};
  return scene;
}

/// A site in the middle of the tooth's top face.
const CutSite kOnTop{.center_m = Vector3(0, 0, 0.010), .axis = Vector3(0, 0, 2), .radius_m = 0.00175};

TEST(MeshScenes, ARegionGetsTheTissueOfItsNameAndLengthsAreScaled) {
  const TemporaryFile file(".obj", ToothObjText(0.04));
  const SceneParams scene = Tooth();
  const auto solid = LoadSceneSolid(file.path(), 0.04, kOnTop, scene);
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_NEAR(solid->solid->Bounds().sizes().z(), 0.010, 1e-6);
  EXPECT_EQ(solid->solid->MaterialAt({0, 0, 0.0099}), 0);
  EXPECT_EQ(solid->solid->MaterialAt({0, 0, 0.0090}), 1);
  EXPECT_EQ(solid->solid->MaterialAt({0, 0, 0.0060}), 2);
  // the region "nerve" does not bound the solid: the distance at its centre is that to the tooth's surface
  EXPECT_NEAR(solid->solid->SignedDistance({0, 0, 0.005}), -0.004, 1e-6);
  const Bone bone = PackScene(*solid, scene);
  std::array<double, 3> volumes{};
  for (const MassPoint& point : bone.points) volumes.at(point.material) += point.volume_m3;
  const double ball = 4.0 / 3.0 * M_PI * 8e-9, box = 0.8e-6, core = 0.009 * 0.007 * 0.009;
  EXPECT_NEAR(volumes[2], ball, 0.05 * ball);
  EXPECT_NEAR(volumes[0], box - core, 0.05 * (box - core));
  EXPECT_NEAR(volumes[0] + volumes[1] + volumes[2], box, 0.005 * box);
}

TEST(MeshScenes, AStarMatchesAnyRegionAndAnUnmatchedRegionGetsTheSolidsTissue) {
  const TemporaryFile file(".obj", ToothObjText(1.0));
  SceneParams scene = Tooth();
  const auto middle = [&] {
    const auto solid = LoadSceneSolid(file.path(), 1.0, kOnTop, scene);
    return solid ? solid->solid->MaterialAt({0, 0, 0.005}) : MaterialIndex{99};
  };
  EXPECT_EQ(middle(), 2);
  scene.mesh_tissue.regions[0].name = "*";
  EXPECT_EQ(middle(), 2);
  scene.mesh_tissue.regions[0].name = "marrow";
  EXPECT_EQ(middle(), 1);
}

TEST(MeshScenes, ASiteMustLieNearTheSurfaceAndPointOutward) {
  const TemporaryFile file(".obj", ToothObjText(1.0));
  const auto refusal = [&](const Vector3& center, const Vector3& axis) -> std::string {
    const auto solid =
        LoadSceneSolid(file.path(), 1.0, {.center_m = center, .axis = axis, .radius_m = 0.001}, Tooth());
    if (solid) return "accepted";
    EXPECT_EQ(solid.error().kind, MeshErrorKind::kCupOffMesh);
    return solid.error().message;
  };
  EXPECT_EQ(refusal({0, 0, 0.010}, {0, 0, 1}), "accepted");
  EXPECT_EQ(refusal({0.001, 0, 0.0102}, {0, 0, 1}), "accepted") << "a fifth of the radius above";
  EXPECT_EQ(refusal({0.005, 0, 0.004}, {1, 0, 0}), "accepted") << "on a side, looking out of it";
  EXPECT_THAT(refusal({0, 0, 0.010}, {0, 0, -1}), HasSubstr("accepted a quarter of the radius"));
  EXPECT_THAT(refusal({0, 0, 0.0118}, {0, 0, 1}), HasSubstr("its centre is 1.8 mm from the nearest surface"));
  EXPECT_THAT(refusal({0, 0, 0.006}, {0, 0, 1}), HasSubstr("the mesh spans"));
}

TEST(MeshScenes, TheMolarMeshOfTheDataFolderHasPulpAndDentine) {
  const char* data = std::getenv("OSTEON_DATA_DIR");
  const std::filesystem::path file = std::filesystem::path(data ? data : "") / "tooth_molar_with_pulp.obj";
  if (!data || !std::filesystem::exists(file)) GTEST_SKIP() << "skipped, no anatomical meshes";
  SceneParams scene = Tooth();
  scene.mesh_tissue.solid.layers.clear();
  const CutSite site{.center_m = Vector3(0, 0.0005, 0.0080), .axis = Vector3(0, 0, 1), .radius_m = 0.00175};
  const auto solid = LoadSceneSolid(file, 0.041, site, scene);
  ASSERT_TRUE(solid) << solid.error().message;
  EXPECT_NEAR(solid->solid->Bounds().sizes().z(), 0.0206, 0.1e-3);
  const Bone bone = PackScene(*solid, scene);
  double pulp = 0.0, all = 0.0;
  for (const MassPoint& point : bone.points) {
    all += point.volume_m3;
    if (point.material == 2) pulp += point.volume_m3;
  }
  EXPECT_GT(pulp, 0.02 * all);
  EXPECT_LT(pulp, 0.40 * all);
  EXPECT_EQ(solid->solid->MaterialAt({0, 0.0005, 0.0072}), 1) << "dentine below the surface";
}

}  // namespace
}  // namespace osteon::simulation
