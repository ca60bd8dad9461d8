#include <cstring>
#include <limits>
#include <random>
#include <set>

#include <gmock/gmock.h>

#include "mesh_shapes.h"
#include "tests/temporary_path.h"

// Tests of files that give no solid, each with the smallest damage that shows the case. Each error names the
// file, the place in the file, the value found and the values accepted, and no two errors are equal.

namespace osteon::simulation {
namespace {

using testing::HasSubstr;

TriangleMesh Cube() { return MakeBox({0, 0, 0}, {0.02, 0.02, 0.02}); }
TriangleMesh CubeAt(double x_m, double y_m, double z_m) {
  return MakeBox({x_m, y_m, z_m}, {x_m + 0.02, y_m + 0.02, z_m + 0.02});
}
/// A cube between two coordinates, to be turned inside out as a cavity.
TriangleMesh Pit(double low_mm, double high_mm) {
  return MakeBox(Vector3::Constant(low_mm * 1e-3), Vector3::Constant(high_mm * 1e-3));
}

/// The text with the first `from` replaced; the test fails if there is none.
std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

std::string WithoutLastLine(std::string text) {
  text.erase(text.find_last_of('\n', text.size() - 2) + 1);
  return text;
}

/// An OBJ file of the cube, 20 lines, and further lines.
std::string CubePlus(const std::string& lines) { return ObjText(Cube()) + lines; }

/// A damaged file with the error that it must give.
struct Malformed {
  std::string what;  ///< the damage
  std::string extension;
  std::string content;
  MeshErrorKind kind;
  std::string where;  ///< part of the message
};

std::vector<Malformed> AllMalformed() {
  using Kind = MeshErrorKind;
  const std::string obj = ObjText(Cube()), stl = StlText(Cube()), ply = PlyText(Cube());
  const std::string binary_stl = BinaryStl(Cube()), binary_ply = BinaryPly(Cube());
  std::string nan_stl = binary_stl, nan_ply = binary_ply, far_index_ply = binary_ply;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(nan_stl.data() + 84 + 50 * 3 + 12 + 4, &nan, 4);
  std::memcpy(nan_ply.data() + nan_ply.find("end_header\n") + 11 + 12 * 2 + 8, &nan, 4);
  const std::int32_t far = 8;
  std::memcpy(far_index_ply.data() + far_index_ply.size() - 4, &far, 4);
  TriangleMesh flipped = Cube(), open = Cube(), dented = MakeIcosphere({0, 0, 0}, 0.02, 2);
  std::swap(flipped.triangles[7][0], flipped.triangles[7][1]);
  open.triangles.pop_back();
  dented.vertices_m[0] *= -1.2;
  TriangleMesh islands;
  for (int i = 0; i < 65; ++i) {
    const Vector3 low(0.012 * (i % 9), 0.012 * (i / 9), 0);
    islands = Join(islands, MakeBox(low, low + Vector3::Constant(0.01)));
  }
  TriangleMesh sheet = Cube();
  sheet.vertices_m.insert(sheet.vertices_m.end(), {{0.03, 0, 0}, {0.04, 0, 0}, {0.03, 0.01, 0}});
  sheet.triangles.insert(sheet.triangles.end(), {{8, 9, 10}, {8, 10, 9}});

  return {
      // files
      {"an empty file", ".stl", "", Kind::kEmpty, "found an empty file"},
      {"an unknown extension", ".step", obj, Kind::kFormat,
       "found extension '.step', accepted .stl, .obj, .ply"},
      // OBJ
      {"comments only", ".obj", "# nothing\n", Kind::kEmpty, "found no faces and 0 vertices in an OBJ file"},
      {"bytes that are no text", ".obj", obj + std::string("v 1\0 2\n", 8), Kind::kUnreadable,
       "found 0x00, accepted text"},
      {"words that are no OBJ", ".obj", "Dear reader\n" + obj, Kind::kUnreadable, ".obj:1: found 'Dear'"},
      {"a coordinate that is no number", ".obj", Replaced(obj, "v 20", "v 2o"), Kind::kUnreadable,
       ".obj:2: found coordinate '2o.000000'"},
      {"a vertex cut short", ".obj", CubePlus("v 1 2\n"), Kind::kUnreadable,
       ".obj:21: found a vertex of 2 numbers"},
      {"nan", ".obj", Replaced(obj, "v 20.000000", "v nan"), Kind::kNotFinite,
       ".obj:2: found coordinate 'nan'"},
      {"inf", ".obj", Replaced(obj, "v 20.000000", "v -inf"), Kind::kNotFinite,
       ".obj:2: found coordinate '-inf'"},
      {"a number beyond floats", ".obj", Replaced(obj, "v 20.000000", "v 1e39"), Kind::kNotFinite,
       "found coordinate '1e39'"},
      {"a vertex of weight 0", ".obj", CubePlus("v 1 2 3 0\n"), Kind::kUnreadable,
       "found a vertex of weight 0"},
      {"an index out of range", ".obj", CubePlus("f 1 2 9\n"), Kind::kUnreadable,
       ".obj:21: found vertex index 9, accepted 1 … 8"},
      {"a normal out of range", ".obj", CubePlus("f 1//1 2//1 3//1\n"), Kind::kUnreadable,
       "found normal index 1"},
      {"a negative index too far back", ".obj", CubePlus("f -1 -2 -9\n"), Kind::kUnreadable,
       ".obj:21: found index -9 with 8 before it"},
      {"index 0", ".obj", CubePlus("f 0 1 2\n"), Kind::kUnreadable, "found index 0 with 8 before it"},
      {"an index that is no number", ".obj", CubePlus("f 1 2 three\n"), Kind::kUnreadable,
       "found corner 'three'"},
      {"a face of two corners", ".obj", CubePlus("f 1 2\n"), Kind::kUnreadable, "found 2 corners after f"},
      {"a polygon around a hole", ".obj",
       "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 1 1 0\nv 2 1 0\nv 1 2 0\nf 1 2 3 1 4 6 5 4\n", Kind::kUnreadable,
       ".obj:7: found a polygon that visits a vertex twice"},
      {"a line that goes on behind the last", ".obj", CubePlus("f 1 2 3 \\"), Kind::kUnreadable,
       ".obj:21: found '\\' at the end of the last line"},
      {"a continued line that nothing announces", ".obj", CubePlus("usemtl C:\\bone\\\n1 2 3\n"),
       Kind::kUnreadable, ".obj:22: found '1', accepted a statement of OBJ"},
      {"a decimal comma", ".obj", Replaced(obj, "v 20.000000", "v 20,000000"), Kind::kUnreadable,
       ".obj:2: found coordinate '20,000000', accepted a finite number with a decimal point"},
      {"two signs", ".obj", Replaced(obj, "v 20.000000", "v +-20"), Kind::kUnreadable,
       ".obj:2: found coordinate '+-20'"},
      {"a free-form surface", ".obj", CubePlus("surf 0 1 0 1 1 2 3 4\n"), Kind::kUnreadable,
       ".obj:21: found a free-form surface"},
      {"another file called", ".obj", CubePlus("call more.obj\n"), Kind::kUnreadable,
       ".obj:21: found 'call'"},
      {"a polygon that crosses itself", ".obj", "v 0 0 0\nv 9 9 0\nv 9 0 0\nv 0 8 0\nf 1 2 3 4\n",
       Kind::kUnreadable, ".obj:5: found a polygon that crosses itself"},
      {"vertices without faces", ".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", Kind::kEmpty,
       "found no faces and 3 vertices in an OBJ file"},
      // files of another kind
      {"a pointer of git LFS", ".stl",
       "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 2500084\n", Kind::kFormat,
       "found a pointer of git LFS, not the mesh (git lfs pull fetches it), accepted an STL file"},
      {"a ZIP archive", ".stl", std::string("PK\x03\x04\x14\0\0\0\x08\0", 10) + binary_stl, Kind::kFormat,
       "found a ZIP archive (3MF files"},
      {"a gzip file", ".ply", std::string("\x1f\x8b\x08\0\0\0\0\0\0\x03", 10) + "bytes", Kind::kFormat,
       "found a gzip file, accepted a PLY file"},
      {"a web page", ".obj", "<!DOCTYPE html>\n<html><body>404</body></html>\n", Kind::kFormat,
       "found a web page or XML, accepted an OBJ file"},
      {"UTF-16", ".obj", std::string("\xff\xfev\0 \0", 6), Kind::kFormat, "found text in UTF-16"},
      {"an STL named as an OBJ", ".obj", stl, Kind::kFormat, "found an STL file, accepted an OBJ file"},
      {"a PLY named as an STL", ".stl", binary_ply, Kind::kFormat, "found a PLY file, accepted an STL file"},
      {"an OBJ named as an STL", ".stl", obj, Kind::kUnreadable,
       ".stl:1: found 'v 0.000000 0.000000 0.000000', accepted 'solid'"},
      {"a volume", ".ply", "NRRD0004\ntype: short\n", Kind::kFormat, "found an NRRD volume"},
      // STL as text
      {"text cut off in a facet", ".stl", stl.substr(0, stl.find("endloop")), Kind::kUnreadable,
       ".stl:6: found the end of the file within a facet"},
      {"text cut off between facets", ".stl", WithoutLastLine(stl), Kind::kUnreadable,
       ".stl:85: found the end of the file within a solid"},
      {"a facet of two corners", ".stl", Replaced(stl, "vertex 0.000000 0.000000 0.000000\n", ""),
       Kind::kUnreadable, "found 'endloop', accepted 'vertex' and 3 finite numbers"},
      {"text with nan", ".stl", Replaced(stl, "vertex 20", "vertex nan 20"), Kind::kUnreadable,
       "found 'vertex nan"},
      {"a coordinate of inf in text", ".stl", Replaced(stl, "vertex 20.000000", "vertex inf"),
       Kind::kNotFinite, "found coordinate 'inf'"},
      {"a normal that is no number", ".stl", Replaced(stl, "normal 0 0 0", "normal 0 0 x"), Kind::kUnreadable,
       ".stl:2: found 'facet normal 0 0 x', accepted 'facet normal' and 3 numbers"},
      {"a solid without facets", ".stl", "solid nothing\nendsolid nothing\n", Kind::kEmpty,
       "found no facets in an STL file"},
      {"words behind the last solid", ".stl", stl + "\nexported by hand\n", Kind::kUnreadable,
       ".stl:88: found 'exported by hand', accepted 'solid'"},
      {"a decimal comma in text", ".stl", Replaced(stl, "vertex 20.000000", "vertex 20,000000"),
       Kind::kUnreadable, "found coordinate '20,000000', accepted a finite number with a decimal point"},
      // STL as bytes
      {"bytes cut off in the header", ".stl", binary_stl.substr(0, 50), Kind::kUnreadable,
       "byte 50: found the end"},
      {"bytes cut off in a triangle", ".stl", binary_stl.substr(0, binary_stl.size() - 7), Kind::kUnreadable,
       "byte 80: found 12 triangles announced and 593 bytes"},
      {"a wrong triangle count", ".stl",
       Replaced(binary_stl, std::string("\x0c\0\0\0", 4), std::string("\x0d\0\0\0", 4)), Kind::kUnreadable,
       "found 13 triangles announced and 600 bytes"},
      {"bytes behind the last triangle", ".stl", binary_stl + "signed", Kind::kUnreadable,
       "found 12 triangles announced and 606 bytes behind the header (room for 12)"},
      {"a triangle count of 0", ".stl",
       Replaced(binary_stl, std::string("\x0c\0\0\0", 4), std::string("\0\0\0\0", 4)), Kind::kUnreadable,
       "found 0 triangles announced and 600 bytes behind the header (room for 12)"},
      {"a wrong count behind the word solid", ".stl",
       "solid bone" +
           Replaced(binary_stl, std::string("\x0c\0\0\0", 4), std::string("\x07\0\0\0", 4)).substr(10),
       Kind::kUnreadable, "byte 80: found 7 triangles announced and 600 bytes"},
      {"nan in bytes", ".stl", nan_stl, Kind::kNotFinite, "byte 250: triangle 3: found coordinate nan"},
      // PLY
      {"no PLY at all", ".ply", obj, Kind::kUnreadable, ".ply:1: found 'v 0.000000"},
      {"a header without an end", ".ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n",
       Kind::kUnreadable, ".ply:4: found no end of the header"},
      {"a PLY without a format", ".ply", Replaced(ply, "format ascii 1.0\n", ""), Kind::kUnreadable,
       "found no format"},
      {"a type that is none", ".ply", Replaced(ply, "property float y", "property flaot y"),
       Kind::kUnreadable, ".ply:5: found type 'flaot', accepted char"},
      {"a line no header has", ".ply", Replaced(ply, "property float y", "properly float y"),
       Kind::kUnreadable, ".ply:5: found 'properly float y'"},
      {"an element twice", ".ply",
       Replaced(ply, "element face", "element vertex 24\nproperty float x\nelement face"), Kind::kUnreadable,
       ".ply:7: found element 'vertex' a second time (first in line 3)"},
      {"an element twice before bytes", ".ply",
       Replaced(binary_ply, "end_header", "element face 2\nproperty char x\nend_header"), Kind::kUnreadable,
       ".ply:9: found element 'face' a second time (first in line 7)"},
      {"a coordinate twice", ".ply", Replaced(ply, "property float y", "property float x"), Kind::kUnreadable,
       ".ply:5: found property 'x' of element 'vertex' behind 'x'"},
      {"two lists of corners", ".ply",
       Replaced(ply, "end_header", "property list uchar int vertex_index\nend_header"), Kind::kUnreadable,
       ".ply:9: found property 'vertex_index' of element 'face' behind 'vertex_indices'"},
      {"two formats", ".ply", Replaced(ply, "element vertex", "format ascii 1.0\nelement vertex"),
       Kind::kUnreadable, ".ply:3: found a second format"},
      {"more faces than announced", ".ply", Replaced(ply, "element face 12", "element face 7"),
       Kind::kUnreadable, ".ply:25: found 12 rows of face, accepted the 7 that are announced in line 7"},
      {"more bytes than announced", ".ply", Replaced(binary_ply, "element face 12", "element face 11"),
       Kind::kUnreadable, "found 13 bytes behind the last face, accepted the end of the file (11 rows"},
      {"points without faces", ".ply",
       Replaced(ply.substr(0, ply.find("3 0 2 1")), "element face 12", "element face 0"), Kind::kEmpty,
       "found no faces and 8 vertices in a PLY file (a cloud of points?)"},
      {"vertices without z", ".ply", Replaced(ply, "property float z", "property float w"), Kind::kUnreadable,
       "found no property z"},
      {"faces without corners", ".ply", Replaced(ply, "vertex_indices", "edge_indices"), Kind::kUnreadable,
       "found no list vertex_indices"},
      {"more vertices announced than there are", ".ply",
       Replaced(ply, "element vertex 8", "element vertex 9"), Kind::kUnreadable,
       "vertex 8: found '1' behind its last value, accepted the end of the line"},
      {"more faces announced than there are", ".ply", Replaced(ply, "element face 12", "element face 13"),
       Kind::kUnreadable, "found the end of the file before face 12"},
      {"a count beyond the file", ".ply", Replaced(ply, "element face 12", "element face 4000000000"),
       Kind::kUnreadable, "found elements announced that take 8000000048 bytes"},
      {"elements that take no room", ".ply",
       Replaced(ply, "end_header", "element nothing 4000000000\nend_header"), Kind::kUnreadable,
       "found element 'nothing' without properties"},
      {"a vertex index out of range", ".ply", Replaced(ply, "\n3 0 2 1\n", "\n3 0 2 8\n"), Kind::kUnreadable,
       "face 0: found vertex index 8, accepted 0 … 7"},
      {"a negative vertex index", ".ply", Replaced(ply, "\n3 0 2 1\n", "\n3 0 2 -1\n"), Kind::kUnreadable,
       "face 0: found vertex index -1"},
      {"a face of one corner", ".ply", Replaced(ply, "\n3 0 2 1\n", "\n1 0\n"), Kind::kUnreadable,
       "face 0: found 1 corners"},
      {"a pinched polygon", ".ply", Replaced(ply, "\n3 0 2 1\n", "\n5 0 2 1 0 4\n"), Kind::kUnreadable,
       ".ply:18: found a polygon that visits a vertex twice"},
      {"bytes cut off in the faces", ".ply", binary_ply.substr(0, binary_ply.size() - 5), Kind::kUnreadable,
       "face 11: found the end of the file"},
      {"nan among the vertices' bytes", ".ply", nan_ply, Kind::kNotFinite, "vertex 2: found z = nan"},
      {"an index out of range in bytes", ".ply", far_index_ply, Kind::kUnreadable,
       "face 11: found vertex index 8"},
      // whole files of surfaces that bound nothing
      {"an open edge", ".obj", ObjText(open), Kind::kOpen,
       "the first of 3 from (20.0000, 20.0000, 0.0000) mm to (20.0000, 0.0000, 20.0000) mm: found triangle"},
      {"an edge with four triangles", ".stl", StlText(Join(Cube(), CubeAt(0.02, 0.02, 0))),
       Kind::kNonManifold, "found 4 triangles at it"},
      {"a vertex where two cubes meet", ".stl", StlText(Join(Cube(), CubeAt(0.02, 0.02, 0.02))),
       Kind::kNonManifold, "vertex at (20.0000, 20.0000, 20.0000) mm"},
      {"a flipped face", ".ply", PlyText(flipped), Kind::kOrientation, "wound in contrary senses"},
      {"a surface through itself", ".stl", StlText(dented), Kind::kSelfIntersecting,
       "self-intersection at ("},
      {"overlapping shells", ".obj", ObjText(Join(Cube(), CubeAt(0.019, 0.018, 0.017))),
       Kind::kSelfIntersecting, "through triangle"},
      {"a region that crosses its parent", ".obj",
       "g Tooth\n" + ObjText(Cube()) + "g Nerve\n" +
           ObjText(MakeBox({0.005, 0.005, 0.005}, {0.01, 0.01, 0.03}), 8),
       Kind::kSelfIntersecting, "of 'Nerve' through triangle"},
      {"a cavity in a cavity", ".obj", ObjText(Join(Cube(), InsideOut(Join(Pit(2, 18), Pit(5, 15))))),
       Kind::kContradictory, "found it wound inwards inside a cavity"},
      {"a hole in nothing", ".obj",
       ObjText(Join(Cube(), InsideOut(MakeBox({0.03, 0, 0}, {0.04, 0.01, 0.01})))), Kind::kContradictory,
       "found it wound inwards with nothing around it"},
      {"a flat shell", ".obj", ObjText(sheet), Kind::kNoVolume, "shell 1 '' at (33.3333"},
      {"a sheet of two sides", ".obj", "v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\nf 1 3 2\n", Kind::kNoVolume,
       "found a volume of 0 mm^3"},
      {"a file in metres", ".obj", ObjText(MakeBox({0, 0, 0}, {20e-6, 20e-6, 20e-6})), Kind::kNoVolume,
       "times --scale"},
      {"a file in micrometres", ".obj", ObjText(MakeBox({0, 0, 0}, {2, 2, 2})), Kind::kTooLarge,
       "found a size of 2000 mm"},
      {"a mesh far away", ".obj", ObjText(CubeAt(11, 0, 0)), Kind::kTooLarge, "accepted within ±10000 mm"},
      {"sixty-five islands", ".obj", ObjText(islands), Kind::kContradictory, "found 65 separate shells"},
  };
}

TEST(MeshMalformed, EachMalformedFileIsRefusedWithItsOwnMessage) {
  const std::vector<Malformed> cases = AllMalformed();
  EXPECT_GE(cases.size(), 50u);
  std::set<std::string> messages;
  for (const Malformed& c : cases) {
    SCOPED_TRACE(c.what);
    const TemporaryFile file(c.extension, c.content);
    const auto loaded = LoadMesh(file.path());
    if (loaded) {
      ADD_FAILURE() << "was accepted";
      continue;
    }
    const MeshError& error = loaded.error();
    EXPECT_EQ(error.kind, c.kind) << error.message;
    EXPECT_TRUE(error.message.starts_with(file.path().string() + ":")) << error.message;
    EXPECT_THAT(error.message, HasSubstr(c.where));
    EXPECT_THAT(error.message, HasSubstr("accepted"));
    EXPECT_TRUE(messages.insert(error.message).second) << "said twice: " << error.message;
  }
}

TEST(MeshMalformed, AFolderIsRefusedAsAMissingFile) {
  const std::filesystem::path folder = TemporaryPath("osteon_folder.stl");
  std::filesystem::create_directories(folder);
  const auto loaded = LoadMesh(folder);
  std::filesystem::remove(folder);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().kind, MeshErrorKind::kMissing);
  EXPECT_THAT(loaded.error().message, HasSubstr("osteon_folder.stl: found a folder, accepted a file"));
}

// Small valid files are damaged at random: truncated, with bytes changed, erased, copied or inserted. Each
// must give a closed mesh or an error that names the file, without a crash, a hang or an exception.
TEST(MeshMalformed, DamagedBytesGiveAMeshOrAnError) {
  const TriangleMesh mesh = MakeIcosphere({0.01, 0.02, 0.03}, 0.01, 1);
  std::mt19937 random{2024};
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  int accepted = 0, refused = 0;
  for (const auto& [extension, sound] : {std::pair<std::string, std::string>{".obj", ObjText(mesh)},
                                         {".stl", StlText(mesh)},
                                         {".stl", BinaryStl(mesh)},
                                         {".ply", PlyText(mesh)},
                                         {".ply", BinaryPly(mesh)}}) {
    for (int n = 0; n < 300; ++n) {
      std::string content = sound;
      for (std::size_t edits = 1 + below(3); edits > 0; --edits) {
        // at least half of the changes are near the beginning, where headers are
        const std::size_t at =
            below(below(2) == 0 ? std::min<std::size_t>(content.size(), 300) : content.size());
        switch (below(6)) {
          case 0:
            content.resize(at);
            break;
          case 1:
            content[at] = static_cast<char>(below(256));
            break;
          case 2:
            content[at] = static_cast<char>(content[at] ^ (1 << below(8)));
            break;
          case 3:
            content.erase(at, 1 + below(20));
            break;
          case 4:
            content.insert(at, content.substr(below(content.size()), below(60)));
            break;
          default:
            content.insert(at, 1, "0123456789-.eE/ \n\"solid"[below(23)]);
            break;
        }
        if (content.empty()) break;
      }
      const TemporaryFile file(extension, content);
      auto loaded = LoadMesh(file.path());
      if (loaded) {
        ++accepted;
        EXPECT_GT(SignedVolume_m3(loaded->mesh), 0.0);
        EXPECT_TRUE(CheckMesh(loaded->mesh, "again"));
      } else {
        ++refused;
        EXPECT_TRUE(loaded.error().message.starts_with(file.path().string())) << loaded.error().message;
      }
    }
  }
  EXPECT_GT(refused, 500);
  EXPECT_GT(accepted, 50);
  std::printf("damaged files: %d refused, %d accepted\n", refused, accepted);
}

}  // namespace
}  // namespace osteon::simulation
