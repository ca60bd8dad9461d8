#include "simulation/surface/surface_export.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

#include <fmt/format.h>

#include "base/output_file.h"
#include "simulation/surface/millimetres.h"

namespace osteon::surface {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Cuts each quad into two triangles along the shorter diagonal.
std::vector<Triangle> Triangulate(const WeldedSurface& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(2 * mesh.quads.size());
  for (const auto& q : mesh.quads) {
    const auto& v = mesh.vertices_mm;
    if (Norm(v[q[0]] - v[q[2]]) <= Norm(v[q[1]] - v[q[3]])) {
      triangles.push_back({q[0], q[1], q[2]});
      triangles.push_back({q[0], q[2], q[3]});
    } else {
      triangles.push_back({q[1], q[2], q[3]});
      triangles.push_back({q[1], q[3], q[0]});
    }
  }
  return triangles;
}

/// The file name's extension in lower case, with its dot.
std::string ExtensionOf(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/// Appends a number's bytes as they are in memory: little endian on every machine that this is built for.
template <class T>
void Append(std::string& bytes, T value) {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), &value, sizeof(T));
  bytes.append(raw.data(), raw.size());
}

void Append(std::string& bytes, Vec3 p) {
  Append(bytes, p.x);
  Append(bytes, p.y);
  Append(bytes, p.z);
}

/// A binary STL file.
std::string StlText(const WeldedSurface& mesh, const std::vector<Triangle>& triangles) {
  constexpr std::size_t kHead = 80;
  std::string bytes = "carved bone, mm";
  bytes.resize(kHead, ' ');
  Append(bytes, static_cast<std::uint32_t>(triangles.size()));
  for (const Triangle& t : triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]], b = mesh.vertices_mm[t[1]], c = mesh.vertices_mm[t[2]];
    const Vec3 n = Cross(b - a, c - a);
    const float length = Norm(n);
    Append(bytes, length > 0.0F ? (1.0F / length) * n : Vec3{});
    for (const Vec3& p : {a, b, c}) Append(bytes, p);
    Append(bytes, std::uint16_t{0});
  }
  return bytes;
}

/// A binary PLY file.
std::string PlyText(const WeldedSurface& mesh, const std::vector<Triangle>& triangles) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment carved bone, mm\nelement vertex {}\nproperty float x\n"
      "property float y\nproperty float z\nelement face {}\nproperty list uchar uint vertex_indices\n"
      "end_header\n",
      mesh.vertices_mm.size(), triangles.size());
  for (const Vec3& p : mesh.vertices_mm) Append(bytes, p);
  for (const Triangle& t : triangles) {
    Append(bytes, std::uint8_t{3});
    for (const std::uint32_t v : t) Append(bytes, v);
  }
  return bytes;
}

std::string ObjText(const WeldedSurface& mesh, const std::vector<Triangle>& triangles) {
  std::string text = "# carved bone, mm\n";
  for (const Vec3& p : mesh.vertices_mm)
    fmt::format_to(std::back_inserter(text), "v {} {} {}\n", p.x, p.y, p.z);
  for (const Triangle& t : triangles)
    fmt::format_to(std::back_inserter(text), "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

}  // namespace

simulation::TriangleMesh ToTriangles(const WeldedSurface& mesh) {
  simulation::TriangleMesh triangles;
  for (const Vec3& p : mesh.vertices_mm) triangles.vertices_m.push_back(ToMetres(p));
  triangles.triangles = Triangulate(mesh);
  return triangles;
}

std::string ValidateSurfaceName(const std::filesystem::path& path) {
  const std::string extension = ExtensionOf(path);
  if (extension == ".stl" || extension == ".ply" || extension == ".obj") return "";
  return fmt::format("found {}, accepted a name that ends in .stl, .ply or .obj", path.string());
}

tl::expected<SurfaceFigures, simulation::FileError> WriteSurface(const std::filesystem::path& path,
                                                                 const CarvedField& field,
                                                                 double drop_below_mm3) {
  const std::string extension = ExtensionOf(path);
  // if the mesh with sharp rims does not pass CheckMesh, export a mesh without sharp rims
  WeldedSurface mesh = WeldSurface(field);
  if (simulation::TriangleMesh checked = ToTriangles(mesh);
      !mesh.quads.empty() && !simulation::CheckMesh(checked, path.string()))
    mesh = WeldSurface(field, {.sharp_rims = false});
  const PieceFigures pieces = DropPiecesBelow(drop_below_mm3, mesh);
  const std::vector<Triangle> triangles = Triangulate(mesh);
  auto file = simulation::OutputFile::Create(path);
  if (!file) return tl::make_unexpected(file.error());
  file->Write(extension == ".stl"   ? StlText(mesh, triangles)
              : extension == ".ply" ? PlyText(mesh, triangles)
                                    : ObjText(mesh, triangles));
  if (auto written = file->Commit(); !written) return tl::make_unexpected(written.error());
  const EdgeCounts edges = CountEdges(mesh);
  return SurfaceFigures{.triangles = triangles.size(),
                        .volume_mm3 = VolumeOf(mesh),
                        .watertight = !mesh.quads.empty() && edges.open == 0 && edges.over_shared == 0,
                        .pieces = pieces};
}

}  // namespace osteon::surface
