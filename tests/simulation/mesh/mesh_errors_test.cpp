#include <limits>

#include <gmock/gmock.h>

#include "mesh_shapes.h"

// Tests of every reason to refuse a mesh, each with the smallest mesh that shows it. Cubes are 20 mm wide.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

TriangleMesh Cube() { return MakeBox({0, 0, 0}, {0.02, 0.02, 0.02}); }

/// The error of CheckMesh, which must refuse the mesh.
MeshError Refusal(TriangleMesh mesh) {
  const auto checked = CheckMesh(mesh, "the mesh");
  if (checked) ADD_FAILURE() << "the mesh was accepted";
  return checked ? MeshError{} : checked.error();
}

/// The error of LoadMesh, which must refuse the file.
MeshError LoadRefusal(const std::filesystem::path& path) {
  const auto loaded = LoadMesh(path);
  if (loaded) ADD_FAILURE() << "the mesh was accepted";
  return loaded ? MeshError{} : loaded.error();
}

TEST(MeshErrors, ACubeIsReadFromEveryFormatWithItsVolumeInCubicMetres) {
  const TriangleMesh cube = Cube();
  for (const auto& [extension, text] :
       {std::pair{".obj", ObjText(cube)}, {".stl", StlText(cube)}, {".PLY", PlyText(cube)}}) {
    const TemporaryFile file(extension, text);
    const auto loaded = LoadMesh(file.path());
    ASSERT_TRUE(loaded) << loaded.error().message;
    EXPECT_EQ(loaded->mesh.vertices_m.size(), 8u) << extension;  // welded
    EXPECT_NEAR(SignedVolume_m3(loaded->mesh), 8e-6, 1e-15);     // rounding of doubles
    EXPECT_EQ(loaded->report.shells.size(), 1u);
  }
}

TEST(MeshErrors, AMissingFileIsNamed) {
  const MeshError error = LoadRefusal("/nowhere/bone.stl");
  EXPECT_EQ(error.kind, MeshErrorKind::kMissing);
  EXPECT_THAT(error.message, HasSubstr("/nowhere/bone.stl: no such file"));
}

TEST(MeshErrors, AnUnknownFormatIsRefusedWithTheAcceptedOnes) {
  const TemporaryFile file(".step", ObjText(Cube()));
  const MeshError error = LoadRefusal(file.path());
  EXPECT_EQ(error.kind, MeshErrorKind::kFormat);
  EXPECT_THAT(error.message, HasSubstr("found extension '.step', accepted .stl, .obj, .ply"));
}

TEST(MeshErrors, GarbageIsRefusedInEveryFormat) {
  std::string garbage;
  std::uint32_t state = 12345;
  for (int i = 0; i < 4096; ++i) garbage += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  for (const char* extension : {".stl", ".obj", ".ply"}) {
    const TemporaryFile file(extension, garbage);
    const MeshError error = LoadRefusal(file.path());
    EXPECT_TRUE(error.kind == MeshErrorKind::kUnreadable || error.kind == MeshErrorKind::kEmpty)
        << error.message;
    EXPECT_THAT(error.message, HasSubstr(file.path().string()));
  }
}

// A parser that searches for the end of the header must not search forever.
TEST(MeshErrors, PlyWithoutTheEndOfItsHeaderIsRefused) {
  const TemporaryFile file(".ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n");
  const MeshError error = LoadRefusal(file.path());
  EXPECT_EQ(error.kind, MeshErrorKind::kUnreadable);
  EXPECT_THAT(error.message, HasSubstr("end_header"));
}

TEST(MeshErrors, AnEmptyFileIsRefused) {
  for (const char* extension : {".stl", ".obj", ".ply"}) {
    const TemporaryFile file(extension, "");
    const MeshError error = LoadRefusal(file.path());
    EXPECT_TRUE(error.kind == MeshErrorKind::kUnreadable || error.kind == MeshErrorKind::kEmpty)
        << error.message;
  }
  EXPECT_EQ(Refusal({}).kind, MeshErrorKind::kEmpty);
}

TEST(MeshErrors, ATruncatedFileIsRefused) {
  const std::string text = StlText(MakeIcosphere({0, 0, 0}, 0.02, 2));
  const TemporaryFile file(".stl", text.substr(0, text.size() / 2));
  const MeshError error = LoadRefusal(file.path());
  EXPECT_TRUE(error.kind == MeshErrorKind::kOpen || error.kind == MeshErrorKind::kUnreadable)
      << error.message;
}

TEST(MeshErrors, NanAndInfiniteCoordinatesAreRefused) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TriangleMesh mesh = Cube();
    mesh.vertices_m[3].y() = bad;
    const MeshError error = Refusal(mesh);
    EXPECT_EQ(error.kind, MeshErrorKind::kNotFinite);
    EXPECT_THAT(error.message, HasSubstr("vertex 3"));
  }
}

TEST(MeshErrors, AMissingTriangleLeavesThreeOpenEdges) {
  TriangleMesh mesh = Cube();
  mesh.triangles.pop_back();
  const MeshError error = Refusal(mesh);
  EXPECT_EQ(error.kind, MeshErrorKind::kOpen);
  // the open edges join the corners 3, 5 and 7; the first one goes from 3 to 5
  EXPECT_THAT(
      error.message,
      HasSubstr("the first of 3 from (20.0000, 20.0000, 0.0000) mm to (20.0000, 0.0000, 20.0000) mm"));
}

TEST(MeshErrors, AFlippedTriangleIsRefused) {
  TriangleMesh mesh = Cube();
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  const MeshError error = Refusal(mesh);
  EXPECT_EQ(error.kind, MeshErrorKind::kOrientation);
  EXPECT_THAT(error.message, HasSubstr("the first of 3"));
}

TEST(MeshErrors, AnEdgeWithFourTrianglesIsRefused) {
  // two cubes that share an edge: along x = y = 20 mm
  TriangleMesh other = MakeBox({0.02, 0.02, 0}, {0.04, 0.04, 0.02});
  const TemporaryFile file(".stl", StlText(Join(Cube(), other)));
  const MeshError error = LoadRefusal(file.path());
  EXPECT_EQ(error.kind, MeshErrorKind::kNonManifold);
  EXPECT_THAT(error.message, HasSubstr("found 4 triangles"));
}

TEST(MeshErrors, TwoCubesThatShareACornerAreRefused) {
  const TemporaryFile file(".stl", StlText(Join(Cube(), MakeBox({0.02, 0.02, 0.02}, {0.04, 0.04, 0.04}))));
  const MeshError error = LoadRefusal(file.path());
  EXPECT_EQ(error.kind, MeshErrorKind::kNonManifold);
  EXPECT_THAT(error.message, HasSubstr("vertex at (20.0000, 20.0000, 20.0000) mm"));
}

TEST(MeshErrors, ATwoSidedSheetIsRefusedForItsZeroVolume) {
  TriangleMesh mesh;
  mesh.vertices_m = {{0, 0, 0}, {0.02, 0, 0}, {0, 0.02, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_EQ(Refusal(mesh).kind, MeshErrorKind::kNoVolume);
}

TEST(MeshErrors, AFileInMetresIsRefusedWithAHintAtMillimetres) {
  const MeshError error = Refusal(MakeBox({0, 0, 0}, {20e-6, 20e-6, 20e-6}));
  EXPECT_EQ(error.kind, MeshErrorKind::kNoVolume);
  EXPECT_THAT(error.message, HasSubstr("millimetres"));
  EXPECT_EQ(Refusal(MakeBox({0, 0, 0}, {2, 2, 2})).kind, MeshErrorKind::kTooLarge);
}

TEST(MeshErrors, AnInsideOutMeshIsTurnedOutwards) {
  TriangleMesh mesh = InsideOut(Cube());
  const auto checked = CheckMesh(mesh, "the mesh");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_TRUE(checked->flipped);
  EXPECT_NEAR(SignedVolume_m3(mesh), 8e-6, 1e-18);
}

TEST(MeshErrors, AnOverlapOfTwoCubesIsASelfIntersection) {
  // the corner at 20 mm sticks 1 mm into the other cube
  const MeshError error = Refusal(Join(Cube(), MakeBox({0.019, 0.018, 0.017}, {0.04, 0.04, 0.04})));
  EXPECT_EQ(error.kind, MeshErrorKind::kSelfIntersecting);
  EXPECT_THAT(error.message, HasSubstr("accepted none deeper than 0.01 mm"));
}

TEST(MeshErrors, ADentThroughTheOppositeWallIsASelfIntersection) {
  // one vertex of a sphere is pulled through to the other side
  TriangleMesh mesh = MakeIcosphere({0, 0, 0}, 0.02, 2);
  mesh.vertices_m[0] *= -1.2;
  EXPECT_EQ(Refusal(mesh).kind, MeshErrorKind::kSelfIntersecting);
}

TEST(MeshErrors, AnOverlapWithinRoundingIsAccepted) {
  TriangleMesh mesh = Join(Cube(), MakeBox({0.019995, 0.001, 0.001}, {0.04, 0.019, 0.019}));  // 0.005 mm deep
  const auto checked = CheckMesh(mesh, "the mesh");
  EXPECT_TRUE(checked) << checked.error().message;
}

TEST(MeshErrors, ACavityIsAcceptedOnlyIfItIsWoundInwards) {
  const TriangleMesh pit = MakeBox({0.005, 0.005, 0.005}, {0.015, 0.015, 0.015});
  TriangleMesh hollow = Join(Cube(), InsideOut(pit));
  const auto checked = CheckMesh(hollow, "the mesh");
  ASSERT_TRUE(checked) << checked.error().message;
  EXPECT_EQ(checked->shells.size(), 2u);
  const MeshError error = Refusal(Join(Cube(), pit));
  EXPECT_EQ(error.kind, MeshErrorKind::kContradictory);
  EXPECT_THAT(error.message, HasSubstr("found a shell wound outwards inside another"));
}

TEST(MeshErrors, ACollapsedTriangleIsDroppedIfTheSurfaceStaysClosed) {
  std::string text = ObjText(Cube());
  text += "f 1 1 2\n";
  const TemporaryFile file(".obj", text);
  const auto loaded = LoadMesh(file.path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->mesh.triangles.size(), 12u);
  EXPECT_EQ(loaded->report.dropped_triangles, 1u);
}

}  // namespace
}  // namespace osteon::simulation
