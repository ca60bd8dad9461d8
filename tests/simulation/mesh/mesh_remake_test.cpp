#include <numbers>
#include <random>

#include <gmock/gmock.h>

#include "mesh_oracle.h"
#include "mesh_shapes.h"
#include "simulation/mesh/winding_number.h"
#include "simulation/solids/mesh_solid.h"

// Tests of meshes that bound no solid. If a command asks for `remake`, a closed surface is made from them on
// a grid. The oracles are the solids' volumes in closed form. Grids are coarse: 1e5 points, a step of about
// 0.9 mm for a sphere of radius 20 mm.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

constexpr double kRadius_m = 0.02;
constexpr MeshParams kRemake{.remake = true, .remake_grid_points = 1e5};

double SphereVolume_m3(double radius_m) { return 4.0 / 3.0 * std::numbers::pi * std::pow(radius_m, 3); }

/// Writes the mesh to a file and loads the file.
tl::expected<LoadedMesh, MeshError> Load(const TriangleMesh& mesh, const MeshParams& params) {
  const TemporaryFile file(".stl", BinaryStl(mesh));
  return LoadMesh(file.path(), params);
}

/// Expects that the mesh is refused without `remake`, and that with `remake` it has this volume within 1 %.
MeshRemake ExpectRemade(const TriangleMesh& mesh, double volume_m3) {
  const auto refused = Load(mesh, {});
  EXPECT_FALSE(refused);
  const auto loaded = Load(mesh, kRemake);
  if (!loaded || !loaded->report.remake) {
    ADD_FAILURE() << (loaded ? "it was accepted as it is" : loaded.error().message);
    return {};
  }
  EXPECT_NEAR(SignedVolume_m3(loaded->mesh), volume_m3, 0.01 * volume_m3);
  EXPECT_EQ(loaded->report.remake->volume_m3, SignedVolume_m3(loaded->mesh));
  TriangleMesh again = loaded->mesh;
  EXPECT_TRUE(CheckMesh(again, "the remade mesh"));
  return *loaded->report.remake;
}

TriangleMesh WithoutTriangles(TriangleMesh mesh, std::size_t first, std::size_t count) {
  mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first),
                       mesh.triangles.begin() + static_cast<std::ptrdiff_t>(first + count));
  return mesh;
}

TriangleMesh Sphere() { return MakeIcosphere({0, 0, 0}, kRadius_m, 4); }

/// The part of the sphere whose triangles lie below a height: an open surface.
TriangleMesh Below(double height_m) {
  TriangleMesh mesh = Sphere();
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return (mesh.vertices_m[t[0]] + mesh.vertices_m[t[1]] + mesh.vertices_m[t[2]]).z() > 3.0 * height_m;
  });
  return mesh;
}

// Oracle: the sum over all triangles. WindingNumber approximates distant triangles together.
TEST(WindingNumber, AgreesWithTheSumOverAllTriangles) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  TriangleMesh soup;
  for (std::uint32_t i = 0; i < 3000; i += 3) {
    const Vector3 at = 0.02 * Vector3(u(random), u(random), u(random));
    for (int k = 0; k < 3; ++k)
      soup.vertices_m.push_back(at + 0.003 * Vector3(u(random), u(random), u(random)));
    soup.triangles.push_back({i, i + 1, i + 2});
  }
  for (const TriangleMesh& mesh : {Sphere(), Below(0.005), soup}) {
    const WindingNumber winding(mesh);
    double worst = 0.0, sum_of_errors = 0.0;
    constexpr int kPoints = 2000;
    for (int i = 0; i < kPoints; ++i) {
      const Vector3 p = 0.03 * Vector3(u(random), u(random), u(random));
      double sum = 0.0;
      for (const auto& t : mesh.triangles) {
        const Vector3 a = (mesh.vertices_m[t[0]] - p).normalized(),
                      b = (mesh.vertices_m[t[1]] - p).normalized(),
                      c = (mesh.vertices_m[t[2]] - p).normalized();
        sum += std::atan2(a.dot(b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a)) / (2.0 * std::numbers::pi);
      }
      const double error = std::abs(winding.At(p) - sum);
      worst = std::max(worst, error);
      sum_of_errors += error;
    }
    EXPECT_LT(worst, 0.1) << "the margin at which RemakeMesh takes a whole block as decided";
    EXPECT_LT(sum_of_errors / kPoints, 0.01);
  }
  EXPECT_EQ(WindingNumber({}).At({0, 0, 0}), 0.0);
}

TEST(MeshRemake, AHoleOfSixTrianglesIsClosed) {
  const MeshRemake remake = ExpectRemade(WithoutTriangles(Sphere(), 1000, 6), SphereVolume_m3(kRadius_m));
  EXPECT_GE(remake.open_edges, 6u);
  EXPECT_EQ(remake.crowded_edges, 0u);
  EXPECT_EQ(remake.crossings, 0u);
  EXPECT_EQ(remake.shells, 1u);
  EXPECT_EQ(remake.turned_shells, 0u);
  EXPECT_LT(remake.step_m, 1e-3);
}

TEST(MeshRemake, OverlappingSpheresBecomeOneSolidWithoutAnInnerWall) {
  // The centres are 1.2 r apart: the plane between them cuts a cap of height 0.4 r off each sphere.
  const double d = 1.2 * kRadius_m, h = 0.4 * kRadius_m;
  const double cap_m3 = std::numbers::pi * h * h * (kRadius_m - h / 3.0);
  const TriangleMesh mesh = Join(Sphere(), MakeIcosphere({d, 0.0003, 0.0002}, kRadius_m, 4));
  const MeshRemake remake = ExpectRemade(mesh, 2.0 * (SphereVolume_m3(kRadius_m) - cap_m3));
  EXPECT_EQ(remake.open_edges, 0u);
  EXPECT_GT(remake.crossings, 20u);
  EXPECT_EQ(remake.shells, 2u);
  const auto loaded = Load(mesh, kRemake);
  ASSERT_TRUE(loaded);
  EXPECT_EQ(loaded->report.shells.size(), 1u) << "the remade surface";
  // midway between the centres the nearest surface is the circle where the spheres meet, 0.8 r away
  EXPECT_NEAR(MeshSolid(loaded->mesh).SignedDistance({0.5 * d, 0, 0}), -0.8 * kRadius_m, 0.5e-3);
}

TEST(MeshRemake, ACavityWithinAnOpenShellStaysHollow) {
  const TriangleMesh mesh =
      Join(WithoutTriangles(Sphere(), 500, 4), InsideOut(MakeIcosphere({0, 0, 0}, 0.012, 4)));
  const MeshRemake remake = ExpectRemade(mesh, SphereVolume_m3(kRadius_m) - SphereVolume_m3(0.012));
  EXPECT_EQ(remake.shells, 2u);
  EXPECT_EQ(remake.turned_shells, 0u);
  const MeshRemake turned =
      ExpectRemade(InsideOut(mesh), SphereVolume_m3(kRadius_m) - SphereVolume_m3(0.012));
  EXPECT_EQ(turned.turned_shells, 1u) << "the outer one; the inner one is a cavity either way";
}

TEST(MeshRemake, ClosedMeshesAreNotRemade) {
  const TriangleMesh nested = Join(Sphere(), InsideOut(MakeIcosphere({0, 0, 0}, 0.012, 3)));
  for (const TriangleMesh& mesh : {Sphere(), nested, InsideOut(nested)}) {
    const auto before = Load(mesh, {}), after = Load(mesh, kRemake);
    ASSERT_TRUE(before && after);
    EXPECT_FALSE(after->report.remake);
    EXPECT_EQ(after->mesh.vertices_m, before->mesh.vertices_m);
    EXPECT_EQ(after->mesh.triangles, before->mesh.triangles);
  }
}

TEST(MeshRemake, AnInsideOutShellIsTurnedOutwards) {
  const TriangleMesh apart = MakeIcosphere({0.05, 0, 0}, 0.015, 4);
  const MeshRemake remake =
      ExpectRemade(Join(Sphere(), InsideOut(apart)), SphereVolume_m3(kRadius_m) + SphereVolume_m3(0.015));
  EXPECT_EQ(remake.turned_shells, 1u);
  const MeshRemake open =
      ExpectRemade(InsideOut(WithoutTriangles(Sphere(), 7, 3)), SphereVolume_m3(kRadius_m));
  EXPECT_EQ(open.turned_shells, 1u);
}

TEST(MeshRemake, FlippedTrianglesAreTurnedLikeTheirNeighbours) {
  TriangleMesh mesh = Sphere();
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 40)
    std::swap(mesh.triangles[i][0], mesh.triangles[i][1]);
  const MeshRemake remake = ExpectRemade(mesh, SphereVolume_m3(kRadius_m));
  EXPECT_GT(remake.contrary_edges, 100u);
  EXPECT_EQ(remake.turned_shells, 0u);
}

TEST(MeshRemake, SolidsThatShareAnEdgeKeepTheirVolume) {
  const TriangleMesh cubes =
      Join(MakeBox({0, 0, 0}, {0.02, 0.02, 0.02}), MakeBox({0.02, 0.02, 0}, {0.04, 0.04, 0.02}));
  const MeshRemake remake = ExpectRemade(cubes, 16e-6);
  EXPECT_EQ(remake.crowded_edges, 1u);
}

// A segmented bone often has small fragments beside it: only the 64 largest shells are kept.
TEST(MeshRemake, TheSmallestShellsBeyondSixtyFourAreDropped) {
  TriangleMesh mesh = Sphere();
  for (int i = 0; i < 70; ++i)
    mesh = Join(mesh, MakeIcosphere({0.03 + 0.004 * (i % 7), 0.004 * (i / 7 - 5), 0}, 1.2e-3 + 1e-6 * i, 1));
  const MeshRemake remake = ExpectRemade(mesh, SphereVolume_m3(kRadius_m));
  EXPECT_EQ(remake.shells, 71u);
  EXPECT_EQ(remake.dropped_shells, 7u);
}

// First a sheet and parts of a sphere of which half or more is open, then boxes that are too small and too
// large.
TEST(MeshRemake, SurfacesThatEncloseNothingAreRefusedWithTheReason) {
  TriangleMesh sheet;
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) sheet.vertices_m.emplace_back(0.03 * x, 0.02 * y, 0.001 * x * y);
  sheet.triangles = {{0, 1, 2}, {1, 3, 2}};
  for (const TriangleMesh& mesh : {sheet, Below(-0.01), Below(0.0)}) {
    const auto refused = Load(mesh, kRemake);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().kind, MeshErrorKind::kOpen);
    EXPECT_THAT(refused.error().message, HasSubstr("no solid can be made of it: found "));
    EXPECT_THAT(refused.error().message, HasSubstr("found a winding number above 0.8 in "));
  }
  const auto tiny = Load(MakeBox({0, 0, 0}, {20e-6, 20e-6, 20e-6}), kRemake);
  ASSERT_FALSE(tiny);
  EXPECT_EQ(tiny.error().kind, MeshErrorKind::kNoVolume);
  EXPECT_THAT(tiny.error().message, HasSubstr("files are read in millimetres"));
  EXPECT_EQ(Load(MakeBox({0, 0, 0}, {2, 2, 2}), kRemake).error().kind, MeshErrorKind::kTooLarge);
}

// The lower three quarters of a sphere. The remade solid ends near the plane of the rim, and elsewhere its
// surface lies on the triangles.
TEST(MeshRemake, ALargeOpeningIsClosedNearItsRim) {
  const auto loaded = Load(Below(0.01), kRemake);
  ASSERT_TRUE(loaded) << loaded.error().message;
  const MeshSolid solid(loaded->mesh);
  EXPECT_LT(std::abs(solid.SignedDistance({0, 0, -kRadius_m})), 0.05e-3);
  EXPECT_LT(std::abs(solid.SignedDistance({kRadius_m, 0, -0.0002})), 0.05e-3);
  EXPECT_LT(solid.SignedDistance({0, 0, 0}), -0.005);
  EXPECT_GT(solid.SignedDistance({0, 0, 0.016}), 0.0);
}

TEST(MeshRemake, TheWarningTellsTheFindingsAndTheAssumption) {
  const auto loaded = Load(WithoutTriangles(Sphere(), 1000, 1), kRemake);
  ASSERT_TRUE(loaded);
  const std::string text = DescribeRemake(*loaded->report.remake);
  EXPECT_THAT(text,
              HasSubstr("found 3 open edges, 0 edges of more than two triangles, 0 edges between contrary "
                        "senses, 0 edges through triangles, 1 shells; accepted one closed surface"));
  EXPECT_THAT(text, HasSubstr("taken as solid where the winding number is above 0.5"));
  EXPECT_THAT(text, HasSubstr(" cm³, remade on a grid of 0."));
}

}  // namespace
}  // namespace osteon::simulation
