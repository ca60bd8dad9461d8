#include <random>

#include <gmock/gmock.h>

#include "mesh_shapes.h"

// Tests of the repairs of a mesh at loading, of their counts in the report, and of meshes that need no
// repair.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

/// An STL of a sphere in which each corner of each triangle is moved by `amplitude_m` in a random direction:
/// no two triangles share a corner exactly.
std::string Shaken(double amplitude_m) {
  const TriangleMesh mesh = MakeIcosphere({0, 0, 0}, 0.02, 2);
  TriangleMesh soup;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t)
      soup.vertices_m.push_back(mesh.vertices_m[v] +
                                amplitude_m * Vector3(u(random), u(random), u(random)).normalized());
    const auto first = static_cast<std::uint32_t>(soup.vertices_m.size()) - 3;
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return BinaryStl(soup);
}

// The default tolerance of welding is 1 um.
TEST(MeshRepair, SlitsWithinTheToleranceAreClosedAndCounted) {
  const TemporaryFile file(".stl", Shaken(0.3e-6));
  const auto loaded = LoadMesh(file.path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->mesh.triangles.size(), 320u);
  // the sphere has 320 triangles with 162 corners
  EXPECT_EQ(loaded->report.welded_vertices, 3u * 320u - 162u);
  EXPECT_EQ(loaded->report.dropped_triangles, 0u);
  EXPECT_NEAR(SignedVolume_m3(loaded->mesh), SignedVolume_m3(MakeIcosphere({0, 0, 0}, 0.02, 2)), 1e-9);
}

TEST(MeshRepair, WiderSlitsAreRefusedUnlessTheToleranceIsWider) {
  const TemporaryFile file(".stl", Shaken(5e-6));
  const auto refused = LoadMesh(file.path());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, MeshErrorKind::kOpen);
  EXPECT_THAT(refused.error().message, HasSubstr("welding within 0.001 mm does not close them"));
  const auto loaded = LoadMesh(file.path(), {.weld_tolerance_m = 20e-6});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->report.welded_vertices, 3u * 320u - 162u);
  EXPECT_FALSE(LoadMesh(file.path(), {.weld_tolerance_m = 0.0}));
}

// The edges are shorter than the tolerance of 0.1 mm; welding would collapse triangles.
TEST(MeshRepair, AClosedMeshIsNotWeldedEvenIfFinerThanTheTolerance) {
  const TriangleMesh fine = MakeIcosphere({0, 0, 0}, 0.7e-3, 4);
  const TemporaryFile file(".stl", BinaryStl(fine));
  const auto loaded = LoadMesh(file.path(), {.weld_tolerance_m = 1e-4});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->report.welded_vertices, 0u);
  EXPECT_EQ(loaded->mesh.triangles.size(), fine.triangles.size());
  EXPECT_EQ(loaded->mesh.vertices_m.size(), fine.vertices_m.size());
}

// A fine closed ball beside a box with one torn-off corner: only the box's open edges may be welded.
TEST(MeshRepair, OnlyVerticesOfOpenEdgesAreWelded) {
  TriangleMesh mesh = MakeIcosphere({0.005, 0, 0}, 0.7e-3, 4);
  const std::size_t fine = mesh.triangles.size();
  TriangleMesh box = MakeBox({0, 0, 0.002}, {0.003, 0.003, 0.005});
  box.vertices_m.push_back(box.vertices_m[7] + Vector3(0, 0, 30e-6));  // the corner, torn off
  for (int t : {3, 7}) std::replace(box.triangles[t].begin(), box.triangles[t].end(), 7u, 8u);
  mesh = Join(mesh, box);
  const TemporaryFile file(".stl", BinaryStl(mesh));
  EXPECT_FALSE(LoadMesh(file.path()));
  const auto loaded = LoadMesh(file.path(), {.weld_tolerance_m = 1e-4});
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->report.welded_vertices, 1u);
  EXPECT_EQ(loaded->mesh.triangles.size(), fine + 12);
}

// A surface that an exporter split into two groups, one for each material.
TEST(MeshRepair, OpenGroupsThatFitTogetherAreJoined) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {0.02, 0.02, 0.02});
  TriangleMesh lower = box, upper = box;
  lower.triangles.resize(7);
  upper.triangles.erase(upper.triangles.begin(), upper.triangles.begin() + 7);
  const TemporaryFile file(".obj", "g lower\n" + ObjText(lower) + "g upper\n" + ObjText(upper, 8));
  const auto loaded = LoadMesh(file.path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  ASSERT_EQ(loaded->report.shells.size(), 1u);
  EXPECT_EQ(loaded->report.welded_vertices, 0u);  // the groups' vertices coincide exactly: no repair
  EXPECT_NEAR(SignedVolume_m3(loaded->mesh), 8e-6, 1e-14);
}

// Three of the added faces are copies of the first face, two have repeated corners.
TEST(MeshRepair, DuplicateAndCollapsedTrianglesAreDroppedAndCounted) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {0.02, 0.02, 0.02});
  const TemporaryFile file(".obj", ObjText(box) + "f 1 1 2\nf 3 3 3\nf 3 2 1\nf 2 1 3\nf 1 3 2\n");
  const auto loaded = LoadMesh(file.path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->report.dropped_triangles, 2u);
  EXPECT_EQ(loaded->report.duplicate_triangles, 3u);
  EXPECT_EQ(loaded->mesh.triangles.size(), 12u);
  EXPECT_NEAR(SignedVolume_m3(loaded->mesh), 8e-6, 1e-14);
}

TEST(MeshRepair, AScaleConvertsTheFilesUnitToMillimetres) {
  const TriangleMesh box = MakeBox({0, 0, 0}, {0.02, 0.02, 0.02});
  const TemporaryFile file(".ply", PlyText(box));
  const auto inches = LoadMesh(file.path(), {.scale = 25.4});  // a box of 20 inches
  ASSERT_TRUE(inches) << inches.error().message;
  EXPECT_NEAR(SignedVolume_m3(inches->mesh), std::pow(20 * 0.0254, 3), 1e-12);
  for (const double scale : {0.0, -1.0, 1e7, std::nan("")})
    EXPECT_THROW(static_cast<void>(LoadMesh(file.path(), {.scale = scale})), std::invalid_argument) << scale;
  EXPECT_THROW(static_cast<void>(LoadMesh(file.path(), {.weld_tolerance_m = 1e-3})), std::invalid_argument);
}

}  // namespace
}  // namespace osteon::simulation
