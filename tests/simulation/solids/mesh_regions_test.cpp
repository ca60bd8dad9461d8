#include <cstdlib>
#include <random>

#include <gmock/gmock.h>

#include "simulation/solids/mass_properties.h"
#include "simulation/solids/mesh_solid.h"
#include "tests/simulation/mesh/mesh_shapes.h"

// Tests of meshes with shells within shells: a cavity bounds the solid, a region separates tissues.

namespace osteon::simulation {
namespace {

/// A cube about a centre; half_mm is half of its side.
TriangleMesh Box(double half_mm, const Vector3& center_m = Vector3::Zero()) {
  return MakeBox(center_m - Vector3::Constant(half_mm * 1e-3), center_m + Vector3::Constant(half_mm * 1e-3));
}

/// Loads this text as an OBJ file; a refusal fails the test.
LoadedMesh Load(const std::string& obj, const MeshParams& params = {}) {
  const TemporaryFile file(".obj", obj);
  auto loaded = LoadMesh(file.path(), params);
  if (!loaded) {
    ADD_FAILURE() << loaded.error().message;
    return {};
  }
  return std::move(*loaded);
}

/// OBJ text with a named group for each mesh.
std::string Groups(const std::vector<std::pair<std::string, TriangleMesh>>& shells) {
  std::string text;
  std::uint32_t before = 0;
  for (const auto& [name, mesh] : shells) {
    text += "g " + name + "\n" + ObjText(mesh, before);
    before += static_cast<std::uint32_t>(mesh.vertices_m.size());
  }
  return text;
}

/// A map that gives the outermost solid the first material, and the regions the next ones in their order.
TissueMap Cores(std::initializer_list<int> cores) {
  TissueMap map{.shells = {}, .lining = {}};
  for (const int core : cores)
    map.shells.push_back({.layers = {}, .core = static_cast<MaterialIndex>(core), .image = {}});
  return map;
}

TEST(MeshRegions, ABoxInABoxIsARegionIfBothAreWoundOutwards) {
  const LoadedMesh loaded = Load(Groups({{"Nerve", Box(5)}, {"Tooth", Box(10)}}));
  ASSERT_EQ(loaded.report.shells.size(), 2u);
  EXPECT_EQ(loaded.report.shells[0].name, "Nerve");
  EXPECT_EQ(loaded.report.shells[0].kind, ShellKind::kRegion);
  EXPECT_EQ(loaded.report.shells[0].parent, 1u);
  EXPECT_NEAR(loaded.report.shells[0].volume_m3, 1e-6, 1e-15);
  EXPECT_EQ(loaded.report.shells[1].name, "Tooth");
  EXPECT_EQ(loaded.report.shells[1].kind, ShellKind::kSolid);
  EXPECT_EQ(loaded.report.shells[1].parent, std::nullopt);
  EXPECT_EQ(loaded.report.shells[1].triangles, 12u);
  ASSERT_EQ(loaded.regions.size(), 1u);
  EXPECT_EQ(loaded.regions[0].name, "Nerve");
  EXPECT_NEAR(SignedVolume_m3(loaded.mesh), 8e-6, 1e-14);  // the region removes nothing

  const MeshSolid solid(loaded, Cores({1, 2}));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-0.012, 0.012);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 p(u(random), u(random), u(random));
    const Vector3 q = p.cwiseAbs() - Vector3::Constant(0.01);
    const double exact = q.cwiseMax(0.0).norm() + std::min(q.maxCoeff(), 0.0);
    ASSERT_NEAR(solid.SignedDistance(p), exact, 1e-9);  // distance to the outer box; the file has floats
    ASSERT_EQ(solid.MaterialAt(p), p.cwiseAbs().maxCoeff() < 0.005 ? 2 : 1) << p.transpose();
  }
}

TEST(MeshRegions, ABoxInABoxIsACavityIfItIsWoundInwards) {
  const LoadedMesh loaded = Load(Groups({{"Pit", InsideOut(Box(5))}, {"Block", Box(10)}}));
  ASSERT_EQ(loaded.report.shells.size(), 2u);
  EXPECT_EQ(loaded.report.shells[0].kind, ShellKind::kCavity);
  EXPECT_EQ(loaded.report.shells[0].parent, 1u);
  EXPECT_TRUE(loaded.regions.empty());
  EXPECT_NEAR(SignedVolume_m3(loaded.mesh), 7e-6, 1e-14);
  const MeshSolid solid(loaded, Cores({1, 2}));
  EXPECT_NEAR(solid.SignedDistance({0, 0, 0}), 0.005, 1e-9);
  EXPECT_NEAR(solid.SignedDistance({0.007, 0, 0}), -0.002, 1e-9);
}

TEST(MeshRegions, ABallInABallHasLayersBelowItsOwnSurface) {
  const Vector3 center(0.1, -0.05, 0.02);
  for (const bool inside_out : {false, true}) {  // true: both shells are inside out, and loading turns them
    TriangleMesh outer = MakeIcosphere(center, 0.02, 4), inner = MakeIcosphere(center, 0.01, 4);
    if (inside_out) {
      outer = InsideOut(outer);
      inner = InsideOut(inner);
    }
    const LoadedMesh loaded = Load(Groups({{"a", outer}, {"b", inner}}));
    EXPECT_EQ(loaded.report.flipped, inside_out);
    ASSERT_EQ(loaded.regions.size(), 1u);
    TissueMap map = Cores({1, 3});
    map.shells[0].layers = {{.material = 0, .thickness_m = 0.002}};
    map.shells[1].layers = {{.material = 2, .thickness_m = 0.003}};
    const MeshSolid solid(loaded, map);
    const Vector3 u = Vector3(0.3, -0.5, 0.8).normalized();
    // the mesh lies at most 0.04 mm inside its sphere (20 mm, four rounds)
    for (const auto& [radius_mm, material] :
         {std::pair{19.9, 0}, {18.1, 0}, {17.8, 1}, {10.1, 1}, {9.8, 2}, {7.1, 2}, {6.8, 3}, {0.1, 3}})
      EXPECT_EQ(solid.MaterialAt(center + radius_mm * 1e-3 * u), material) << radius_mm;
    EXPECT_NEAR(solid.SignedDistance(center + 0.01 * u), -0.01, 5e-5);
  }
}

// Enamel contains dentine, which contains pulp. The pulp contains a cavity "bubble" with a separate solid
// "stone" in it. The file's order of the shells is mixed.
TEST(MeshRegions, RegionsCavitiesAndSolidsCanBeNested) {
  const LoadedMesh loaded = Load(Groups({{"stone", Box(1)},
                                         {"bubble", InsideOut(Box(2))},
                                         {"pulp", Box(4)},
                                         {"enamel", Box(10)},
                                         {"dentine", Box(8)}}));
  const std::vector<MeshShell>& shells = loaded.report.shells;
  ASSERT_EQ(shells.size(), 5u);
  const std::vector<ShellKind> kinds{ShellKind::kSolid, ShellKind::kCavity, ShellKind::kRegion,
                                     ShellKind::kSolid, ShellKind::kRegion};
  const std::vector<std::optional<std::size_t>> parents{1, 2, 4, std::nullopt, 3};
  for (std::size_t i = 0; i < shells.size(); ++i) {
    EXPECT_EQ(shells[i].kind, kinds[i]) << shells[i].name;
    EXPECT_EQ(shells[i].parent, parents[i]) << shells[i].name;
  }
  ASSERT_EQ(loaded.regions.size(), 2u);  // the outer region comes first
  EXPECT_EQ(loaded.regions[0].name, "dentine");
  EXPECT_EQ(loaded.regions[0].parent, std::nullopt);
  EXPECT_EQ(loaded.regions[1].name, "pulp");
  EXPECT_EQ(loaded.regions[1].parent, 0u);

  const MeshSolid solid(loaded, Cores({1, 2, 3}));
  for (const auto& [x_mm, material, distance_mm] :
       {std::tuple{9.0, 1, -1.0}, {7.0, 2, -3.0}, {3.5, 3, -1.5}, {1.5, 1, 0.5}, {0.7, 1, -0.3}}) {
    const Vector3 p(x_mm * 1e-3, 0, 0);
    if (distance_mm < 0) {
      EXPECT_EQ(solid.MaterialAt(p), material) << x_mm;
    }
    EXPECT_NEAR(solid.SignedDistance(p), distance_mm * 1e-3, 1e-9) << x_mm;
  }
  // by hand: volumes of the full boxes in cubic millimetres, and densities in g/cm^3
  const std::vector<double> densities{3000, 2000, 1000};
  const MassProperties mass = MeshMassProperties(loaded, densities);
  const double box10 = 8000, box8 = 4096, box4 = 512, box2 = 64, box1 = 8;
  EXPECT_NEAR(mass.volume_m3 * 1e9, box10 - box2 + box1, 1e-4);
  EXPECT_NEAR(mass.mass_kg * 1e6, 3 * (box10 - box8) + 2 * (box8 - box4) + 1 * (box4 - box2) + 3 * box1,
              1e-3);
}

// Two groups that share a whole face stay two shells. The same triangles in one group are refused.
TEST(MeshRegions, GroupsThatTouchAreNotWeldedTogether) {
  const TriangleMesh left = Box(5), right = Box(5, {0.01, 0, 0});
  const LoadedMesh apart = Load(Groups({{"left", left}, {"right", right}}));
  EXPECT_EQ(apart.report.shells.size(), 2u);
  EXPECT_EQ(apart.mesh.vertices_m.size(), 16u);
  const TemporaryFile together(".obj", ObjText(Join(left, right)));
  EXPECT_FALSE(LoadMesh(together.path()));
  // a region may share part of a face with its parent
  const LoadedMesh flush = Load(Groups({{"pulp", Box(5, {0.005, 0, 0})}, {"tooth", Box(10)}}));
  ASSERT_EQ(flush.regions.size(), 1u);
  EXPECT_EQ(MeshSolid(flush, Cores({1, 2})).MaterialAt({0.0099, 0, 0}), 2);
}

TEST(MeshRegions, TwoSolidsSideBySideAreAccepted) {
  const LoadedMesh loaded = Load(ObjText(Join(Box(5), Box(5, {0.02, 0, 0}))));
  ASSERT_EQ(loaded.report.shells.size(), 2u);
  for (const MeshShell& shell : loaded.report.shells) EXPECT_EQ(shell.kind, ShellKind::kSolid);
  EXPECT_TRUE(loaded.regions.empty());
}

/// The real molar; its tests are skipped without the folder of anatomical meshes.
class Tooth : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("OSTEON_DATA_DIR");
    if (folder) path_ = std::filesystem::path(folder) / "tooth_molar_with_pulp.obj";
    if (!folder || !std::filesystem::exists(path_)) GTEST_SKIP() << "no anatomical meshes";
  }
  std::filesystem::path path_;
};

TEST_F(Tooth, PulpAndDentineHaveTheirOwnMaterialAndVolume) {
  const auto loaded = LoadMesh(path_, {.scale = 0.041});
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->report.shells.size(), 2u);
  ASSERT_EQ(loaded->regions.size(), 1u);
  EXPECT_EQ(loaded->regions[0].name, "Nerve");
  const MeshSolid solid(*loaded, Cores({1, 2}));
  EXPECT_NEAR(solid.Bounds().sizes().maxCoeff(), 0.0206, 1e-4);  // the data's README
  // volumes by counting grid points, compared with the meshes' exact volumes; the pulp lies entirely inside
  const Vector3 low = solid.Bounds().min(), size = solid.Bounds().sizes();
  const int n = 40;
  double all = 0.0, pulp = 0.0;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3 p = low + Vector3(i % n + 0.5, i / n % n + 0.5, i / (n * n) + 0.5).cwiseProduct(size) / n;
    if (solid.SignedDistance(p) >= 0.0) continue;
    all += size.prod() / (n * n * n);
    if (solid.MaterialAt(p) == 2) pulp += size.prod() / (n * n * n);
  }
  EXPECT_NEAR(all, SignedVolume_m3(loaded->mesh), 0.01 * all);
  EXPECT_NEAR(pulp, SignedVolume_m3(loaded->regions[0].mesh), 0.02 * pulp);
  for (const Vector3& v : loaded->regions[0].mesh.vertices_m) EXPECT_LT(solid.SignedDistance(v), 1e-5);
}

TEST_F(Tooth, IsRefusedIfItsScaleMakesItLargerThanAMetre) {
  const auto loaded = LoadMesh(path_);  // 502 mm: accepted, although no tooth is that large
  ASSERT_TRUE(loaded) << loaded.error().message;
  const auto refused = LoadMesh(path_, {.scale = 4.0});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, MeshErrorKind::kTooLarge);
}

}  // namespace
}  // namespace osteon::simulation
