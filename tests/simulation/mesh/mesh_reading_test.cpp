#include <algorithm>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>

#include "mesh_shapes.h"
#include "simulation/mesh/mesh_file.h"

// Tests of valid files as programs write them, and as people and tools change them: each must be read
// completely. The expected volumes are calculated by hand.

namespace osteon::simulation {
namespace {

TriangleMesh Cube() { return MakeBox({0, 0, 0}, {0.02, 0.02, 0.02}); }

std::string ReplacedAll(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

template <typename T>
void AppendBigEndian(std::string& bytes, T value) {
  std::string some;
  AppendBytes(some, value);
  std::reverse(some.begin(), some.end());
  bytes += some;
}

/// A PLY file of the cube, as text or binary, with an additional element "camera" at `place`: 0 before the
/// vertices, 1 between vertices and faces, 2 behind the faces.
std::string PlyWithCamera(int place, bool is_text) {
  const TriangleMesh cube = Cube();
  const std::string camera =
      "element camera 1\nproperty float view_px\nproperty double k1\nproperty list uchar short viewport\n";
  std::string camera_row = "1.5 2e-3 2 640 480\n";
  if (!is_text) {
    camera_row.clear();
    AppendBytes(camera_row, 1.5f);
    AppendBytes(camera_row, 2e-3);
    AppendBytes(camera_row, std::uint8_t{2});
    for (const int x : {640, 480}) AppendBytes(camera_row, static_cast<std::int16_t>(x));
  }
  const std::string whole = is_text ? PlyText(cube) : BinaryPly(cube);
  std::string head = whole.substr(0, whole.find("end_header\n"));
  std::string body = whole.substr(head.size() + 11);
  const std::size_t faces = is_text ? body.find("3 0 2 1\n") : 8 * 12;
  head.insert(place == 0   ? head.find("element vertex")
              : place == 1 ? head.find("element face")
                           : head.size(),
              camera);
  body.insert(place == 0 ? 0 : place == 1 ? faces : body.size(), camera_row);
  return head + "end_header\n" + body;
}

/// A PLY file of the cube in big-endian doubles, with the faces before the vertices, further lists and
/// colours.
std::string BigEndianPly() {
  const TriangleMesh cube = Cube();
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\ncomment VCGLIB generated\nobj_info by hand\nelement face 12\n"
      "property uchar flags\nproperty list uint ushort vertex_index\nproperty list uchar float texcoord\n"
      "element vertex 8\nproperty list uchar int neighbours\nproperty double z\nproperty uchar red\n"
      "property double x\nproperty double y\nend_header\n";
  for (const auto& t : cube.triangles) {
    AppendBytes(bytes, std::uint8_t{1});
    AppendBigEndian(bytes, std::uint32_t{3});
    for (const std::uint32_t v : t) AppendBigEndian(bytes, static_cast<std::uint16_t>(v));
    AppendBytes(bytes, std::uint8_t{2});
    for (const float x : {0.5f, std::numeric_limits<float>::quiet_NaN()}) AppendBigEndian(bytes, x);
  }
  for (const Vector3& v : cube.vertices_m) {
    AppendBytes(bytes, std::uint8_t{1});
    AppendBigEndian(bytes, std::int32_t{7});
    AppendBigEndian(bytes, v.z() * 1e3);
    AppendBytes(bytes, std::uint8_t{255});
    AppendBigEndian(bytes, v.x() * 1e3);
    AppendBigEndian(bytes, v.y() * 1e3);
  }
  return bytes;
}

/// Text of a cube's six quads, wound outwards: `head`, then for each quad a line of `begin` and four vertex
/// indices, which count from `first`.
std::string QuadCube(const std::string& head, const std::string& begin, int first) {
  std::string text = head;
  const int quads[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                           {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (const auto& quad : quads) {
    text += begin;
    for (const int corner : quad) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

/// The cube's corners as OBJ: the lower square, then the upper one, each in order around the square.
const char* const kCubeCorners =
    "v 0 0 0\nv 20 0 0\nv 20 20 0\nv 0 20 0\nv 0 0 20\nv 20 0 20\nv 20 20 20\nv 0 20 20\n";

/// OBJ text of a prism over an outline: two polygons of all corners, below and above, and a quad for each
/// side.
std::string Prism(const std::vector<std::array<double, 2>>& outline_mm, double height_mm) {
  std::string text;
  const int n = static_cast<int>(outline_mm.size());
  for (const double z : {0.0, height_mm})
    for (const auto& [x, y] : outline_mm)
      text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  std::string below = "f", above = "f";
  for (int i = 0; i < n; ++i) {
    below += " " + std::to_string(n - i);
    above += " " + std::to_string(n + 1 + i);
    const int next = (i + 1) % n;
    text += "f " + std::to_string(i + 1) + " " + std::to_string(next + 1) + " " +
            std::to_string(n + next + 1) + " " + std::to_string(n + i + 1) + "\n";
  }
  return text + below + "\n" + above + "\n";
}

/// A valid file with the volume and number of triangles that it must give.
struct Sound {
  std::string what;  ///< the peculiarity
  std::string extension;
  std::string content;
  double volume_mm3{8000.0};
  std::size_t triangles{12};
};

std::vector<Sound> AllSound() {
  const std::string obj = ObjText(Cube()), stl = StlText(Cube()), ply = PlyText(Cube());
  const std::string mark = "\xef\xbb\xbf";  // byte order mark of UTF-8
  std::string coloured = BinaryStl(Cube()), odd_normals = BinaryStl(Cube());
  const std::string header = "solid COLOR=\xff\x80\x40\xff exported facet";
  std::copy(header.begin(), header.end(), coloured.begin());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t t = 0; t < 12; ++t) {
    coloured[84 + 50 * t + 48] = '\x1f';
    coloured[84 + 50 * t + 49] = '\x80';
    std::memcpy(odd_normals.data() + 84 + 50 * t, &nan, 4);
  }
  std::string padded = BinaryStl(Cube());
  std::fill(padded.begin(), padded.begin() + 80, ' ');
  std::copy_n("solid bone", 10, padded.begin());
  std::string hollow = "g outer\n" + ObjText(Cube());
  const TriangleMesh pit = InsideOut(MakeBox({0.005, 0.005, 0.005}, {0.015, 0.015, 0.015}));
  hollow += "  g pit\n" + ReplacedAll(ReplacedAll(ObjText(pit, 8), "\nf", "\n\t f"), "\nv", "\n  v");
  const std::vector<std::array<double, 2>> el{{0, 0}, {20, 0}, {20, 10}, {10, 10}, {10, 20}, {0, 20}};
  const std::vector<std::array<double, 2>> comb{{0, 0},   {20, 0}, {20, 20}, {16, 20}, {16, 5}, {12, 5},
                                                {12, 20}, {8, 20}, {8, 5},   {4, 5},   {4, 20}, {0, 20}};
  const std::vector<std::array<double, 2>> on_edges{{0, 0}, {10, 0}, {20, 0}, {20, 20}, {10, 20}, {0, 20}};
  // a dart, which is a quad with a reflex corner: a fan of triangles from its first corner would fold over
  const std::vector<std::array<double, 2>> dart{{0, 20}, {10, 0}, {20, 20}, {10, 10}};
  return {
      // OBJ
      {"a byte order mark", ".obj", mark + obj},
      {"CR LF", ".obj", ReplacedAll(obj, "\n", "\r\n")},
      {"CR alone, below a comment", ".obj", ReplacedAll("# a comment\n" + obj, "\n", "\r")},
      {"no line end at the end", ".obj", obj.substr(0, obj.size() - 1)},
      {"a comment that ends in a backslash", ".obj", "# from C:\\bones\\\n" + obj},
      {"one before a face", ".obj", ReplacedAll(obj, "f 1 3 2\n", "# group C:\\bones\\\nf 1 3 2\n")},
      {"one behind a face", ".obj", ReplacedAll(obj, "f 1 3 2\n", "f 1 3 2 # C:\\\n")},
      {"names that end in a backslash", ".obj", "mtllib C:\\bones\\\ng C:\\bones\\\n" + obj},
      {"comments behind statements", ".obj", ReplacedAll(obj, "\nf", " # place\nf") + "# end"},
      {"lines that go on", ".obj", ReplacedAll(obj, "f 1 3 2\n", "f 1 \\\n 3\\\n\t2\n")},
      {"a line that goes on, CR LF", ".obj",
       ReplacedAll(ReplacedAll(obj, "f 1 3 2\n", "f 1 \\\n3 2\n"), "\n", "\r\n")},
      {"tabs and blanks", ".obj", ReplacedAll(ReplacedAll(obj, " ", " \t "), "\n", " \t\n \t")},
      {"an indented cavity", ".obj", hollow, 7000.0, 24},
      {"signs and powers of ten", ".obj", ReplacedAll(obj, "20.000000", "+2.0E+01")},
      {"numbers too small for doubles", ".obj", ReplacedAll(obj, "v 0.000000", "v -1e-400")},
      {"names in Latin-1", ".obj", "g Hüftkopf\xfc\n" + obj},
      {"normals and textures, nan among them", ".obj",
       ReplacedAll("vn nan -nan(ind) 1.#QNAN\nvt 0.5\n" + obj, "f 1 3 2\n", "f 1/1/1 3//1 2/1\n")},
      {"the textures' slash without one", ".obj", ReplacedAll(obj, "f 1 3 2\n", "f 1/ 3// 2/\n")},
      {"quads", ".obj", QuadCube(kCubeCorners, "f", 1)},
      {"quads by negative indices", ".obj", QuadCube(kCubeCorners, "f", -8)},
      {"faces before their vertices", ".obj", QuadCube("", "f", 1) + kCubeCorners},
      {"triangles as quads", ".obj", ReplacedAll(obj, "f 1 3 2\n", "f 1 3 2 2\n")},
      {"triangles as quads, the first corner again", ".obj", ReplacedAll(obj, "f 1 3 2\n", "f 1 3 2 1\n")},
      {"colours", ".obj", ReplacedAll(obj, "\nf 1 3 2", " .5 .5 .5\nf 1 3 2")},
      {"colours with an alpha", ".obj", ReplacedAll(obj, "\nf 1 3 2", " .5 .5 .5 1\nf 1 3 2")},
      {"weights", ".obj", ReplacedAll(obj, "v 20.000000 20.000000 20.000000", "v 40 40 40 2")},
      {"what is no surface", ".obj", "vp 1 2\ns off\nusemtl bone\nusemtl\n" + obj + "l 1 2 3\np 4\n"},
      {"an L as one polygon", ".obj", Prism(el, 10), 3000.0, 20},
      {"a comb as one polygon", ".obj", Prism(comb, 10), 2800.0, 44},
      {"corners along edges", ".obj", Prism(on_edges, 20), 8000.0, 20},
      {"a dart", ".obj", Prism(dart, 10), 1000.0, 12},
      // STL
      {"a byte order mark", ".stl", mark + stl},
      {"CR LF", ".stl", ReplacedAll(stl, "\n", "\r\n")},
      {"capitals, blanks, empty lines", ".stl",
       "\n \n" + ReplacedAll(ReplacedAll(ReplacedAll(stl, "facet", "FACET"), "vertex", "\t  VERTEX "), "\n",
                             "\n\n")},
      {"normals that are none", ".stl", ReplacedAll(stl, "normal 0 0 0", "normal nan -nan(ind) -1.#IND")},
      {"a solid without a name", ".stl", ReplacedAll(stl, " test", "")},
      {"a solid named by a sentence", ".stl",
       ReplacedAll(stl, " test", " facet normal 0 0 1 of C:\\bone\\ \xe9")},
      {"two solids", ".stl", stl + StlText(MakeBox({0.03, 0, 0}, {0.04, 0.01, 0.01})), 9000.0, 24},
      {"triangles without area", ".stl",
       ReplacedAll(
           stl, "endsolid",
           "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 9 0 0\nendloop\nendfacet\n"
           "endsolid")},
      {"bytes of colours behind the word solid", ".stl", coloured},
      {"bytes behind a header of text", ".stl", padded},
      {"bytes with normals that are none", ".stl", odd_normals},
      // PLY
      {"a byte order mark", ".ply", mark + ply},
      {"a byte order mark before bytes", ".ply", mark + BinaryPly(Cube())},
      {"CR LF", ".ply", ReplacedAll(ply, "\n", "\r\n")},
      {"CR alone", ".ply", ReplacedAll(ply, "\n", "\r")},
      {"empty lines", ".ply", ReplacedAll(ply, "\n3 ", "\n\n3 ") + "\n \n"},
      {"a line end behind the bytes", ".ply", BinaryPly(Cube()) + "\n"},
      {"comments in the header", ".ply",
       ReplacedAll(ply, "element face", "comment element vertex 9\nobj_info x\nelement face")},
      {"a camera before, as text", ".ply", PlyWithCamera(0, true)},
      {"a camera between, as text", ".ply", PlyWithCamera(1, true)},
      {"a camera behind, as text", ".ply", PlyWithCamera(2, true)},
      {"a camera before, as bytes", ".ply", PlyWithCamera(0, false)},
      {"a camera between, as bytes", ".ply", PlyWithCamera(1, false)},
      {"a camera behind, as bytes", ".ply", PlyWithCamera(2, false)},
      {"faces first, big-endian, with lists", ".ply", BigEndianPly()},
      {"indices as floats", ".ply", ReplacedAll(ply, "list uchar int", "list uchar float")},
      {"quads", ".ply",
       QuadCube(
           "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
           "property float nx\nelement face 6\nproperty list uint8 int32 vertex_indices\nend_header\n"
           "0 0 0 nan\n20 0 0 1\n20 20 0 1\n0 20 0 1\n0 0 20 1\n20 0 20 1\n20 20 20 1\n0 20 20 -1.#IND\n",
           "4", 0)},
  };
}

TEST(MeshReading, EachValidFileIsReadCompletely) {
  for (const Sound& c : AllSound()) {
    SCOPED_TRACE(c.extension + ": " + c.what);
    const TemporaryFile file(c.extension, c.content);
    const auto loaded = LoadMesh(file.path());
    if (!loaded) {
      ADD_FAILURE() << loaded.error().message;
      continue;
    }
    EXPECT_NEAR(SignedVolume_m3(loaded->mesh) * 1e9, c.volume_mm3, 1e-3);  // files are of floats
    EXPECT_EQ(loaded->mesh.triangles.size(), c.triangles);
    EXPECT_FALSE(loaded->report.flipped);
  }
}

// A name that is not valid UTF-8 is read as Latin-1.
TEST(MeshReading, NamesOfPartsAreConvertedToUtf8) {
  const TemporaryFile file(".obj",
                           "g H\xfc"
                           "fte \xe2\x82\xac\n" +
                               ObjText(Cube()));
  const auto loaded = LoadMesh(file.path());
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->report.shells.at(0).name,
            "H\xc3\xbc"
            "fte \xc3\xa2\xc2\x82\xc2\xac");  // each byte of the euro sign is read as a Latin-1 letter
  const TemporaryFile sound(".obj",
                            "o H\xc3\xbc"
                            "fte # left\n" +
                                ObjText(Cube()));
  EXPECT_EQ(LoadMesh(sound.path())->report.shells.at(0).name,
            "H\xc3\xbc"
            "fte # left");
}

TEST(MeshReading, PartsWithTheSameNameAreMerged) {
  const TemporaryFile file(".stl", StlText(Cube()) + StlText(MakeBox({0.03, 0, 0}, {0.04, 0.01, 0.01})));
  const auto raw = ReadMeshFile(file.path());
  ASSERT_TRUE(raw) << raw.error().message;
  EXPECT_THAT(raw->parts, testing::ElementsAre("test"));
  EXPECT_EQ(raw->part_of_triangle, std::vector<std::uint32_t>(24, 0));
}

// The polygon is a dart, whose reflex corner a simple fan of triangles would fold over.
TEST(MeshReading, ConcavePolygonsAreCutIntoTrianglesOfTheSameOrientation) {
  const TemporaryFile file(".obj", "v 0 20 0\nv 10 0 0\nv 20 20 0\nv 10 10 0\nf 1 2 3 4\n");  // a dart
  const auto raw = ReadMeshFile(file.path());
  ASSERT_TRUE(raw) << raw.error().message;
  ASSERT_EQ(raw->triangles.size(), 2u);
  double area = 0.0;
  for (const auto& [a, b, c] : raw->triangles) {
    const double twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    EXPECT_GT(twice, 0.0);
    area += 0.5 * twice;
  }
  EXPECT_DOUBLE_EQ(area, 100.0);
}

}  // namespace
}  // namespace osteon::simulation
