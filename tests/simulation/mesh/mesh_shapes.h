#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "simulation/mesh/triangle_mesh.h"
#include "tests/temporary_path.h"

// Makes small meshes for tests, and mesh files of them. Meshes are in metres, files in millimetres.

namespace osteon::simulation {

/// Box of 12 triangles, wound outwards.
inline TriangleMesh MakeBox(const Vector3& low, const Vector3& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices_m.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                                 i & 4 ? high.z() : low.z());
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

/// Sphere of 20·4^rounds triangles with all vertices on it.
inline TriangleMesh MakeIcosphere(const Vector3& center, double radius_m, int rounds) {
  const double t = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh;
  mesh.vertices_m = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                     {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t i, std::uint32_t j) {
      const std::pair<std::uint32_t, std::uint32_t> edge = std::minmax(i, j);
      const auto [at, is_new] = middles.try_emplace(edge, static_cast<std::uint32_t>(mesh.vertices_m.size()));
      if (is_new)
        mesh.vertices_m.push_back(mesh.vertices_m[i].normalized() + mesh.vertices_m[j].normalized());
      return at->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = finer;
  }
  for (Vector3& v : mesh.vertices_m) v = center + radius_m * v.normalized();
  return mesh;
}

/// Both meshes as one, without welding.
inline TriangleMesh Join(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices_m.size());
  a.vertices_m.insert(a.vertices_m.end(), b.vertices_m.begin(), b.vertices_m.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({first + i, first + j, first + k});
  return a;
}

/// The mesh with all its triangles wound the other way.
inline TriangleMesh InsideOut(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// A temporary file of the running test, named after the test; it is removed with the object.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& extension, const std::string& content) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path_ = TemporaryPath("osteon_" + std::string(test->test_suite_name()) + "_" + test->name() + extension);
    std::ofstream(path_, std::ios::binary) << content;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// @param before  number of vertices that precede this text in the file
inline std::string ObjText(const TriangleMesh& mesh, std::uint32_t before = 0) {
  std::string text;
  for (const Vector3& v : mesh.vertices_m)
    text += "v " + std::to_string(v.x() * 1e3) + " " + std::to_string(v.y() * 1e3) + " " +
            std::to_string(v.z() * 1e3) + "\n";
  for (const auto& [i, j, k] : mesh.triangles)
    text += "f " + std::to_string(before + i + 1) + " " + std::to_string(before + j + 1) + " " +
            std::to_string(before + k + 1) + "\n";
  return text;
}

/// Triangles without shared vertices, as STL has them.
inline std::string StlText(const TriangleMesh& mesh) {
  std::string text = "solid test\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const std::uint32_t i : t) {
      const Vector3 v = mesh.vertices_m[i] * 1e3;
      text += "vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) +
              "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid test\n";
}

inline std::string PlyText(const TriangleMesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(mesh.vertices_m.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                     std::to_string(mesh.triangles.size()) +
                     "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vector3& v : mesh.vertices_m)
    text += std::to_string(v.x() * 1e3) + " " + std::to_string(v.y() * 1e3) + " " +
            std::to_string(v.z() * 1e3) + "\n";
  for (const auto& [i, j, k] : mesh.triangles)
    text += "3 " + std::to_string(i) + " " + std::to_string(j) + " " + std::to_string(k) + "\n";
  return text;
}

/// Appends the bytes of a value, little-endian as on all supported machines.
template <typename T>
void AppendBytes(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Appends a point as three floats in millimetres.
inline void AppendPoint(std::string& bytes, const Vector3& p_m) {
  for (const double x : {p_m.x(), p_m.y(), p_m.z()}) AppendBytes(bytes, static_cast<float>(x * 1e3));
}

inline std::string BinaryStl(const TriangleMesh& mesh) {
  std::string bytes(80, '\0');
  AppendBytes(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    AppendPoint(bytes, Vector3::Zero());  // the normal, which is not read
    for (const std::uint32_t v : t) AppendPoint(bytes, mesh.vertices_m[v]);
    AppendBytes(bytes, std::uint16_t{0});
  }
  return bytes;
}

inline std::string BinaryPly(const TriangleMesh& mesh) {
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices_m.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
      std::to_string(mesh.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const Vector3& v : mesh.vertices_m) AppendPoint(bytes, v);
  for (const auto& t : mesh.triangles) {
    AppendBytes(bytes, std::uint8_t{3});
    for (const std::uint32_t v : t) AppendBytes(bytes, static_cast<std::int32_t>(v));
  }
  return bytes;
}

}  // namespace osteon::simulation
