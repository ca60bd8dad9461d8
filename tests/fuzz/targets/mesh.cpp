#include <array>
#include <cmath>

#include "simulation/mesh/mesh_file.h"
#include "tests/fuzz/targets/file_claims.h"

// Fuzz target: a mesh file. The input's byte 0 selects the extension (STL, OBJ, PLY); the rest is the file.

namespace osteon::fuzz {
namespace {

using simulation::MeshErrorKind;

// Claims that an error names the file and a place in it: a line of a text file, or a byte of a binary file.
// Errors about the surface itself (open, wound both ways, …) name a place in mm instead.
void ClaimError(const simulation::MeshError& error, const std::filesystem::path& path,
                std::string_view content) {
  const std::string name = path.string();
  Claim(error.message.starts_with(name + ":") && error.message.size() > name.size() + 2,
        "an error names the file");
  if (const long long byte = NumberBehind(error.message, name + ": byte "); byte >= 0)
    Claim(static_cast<unsigned long long>(byte) <= content.size(), "an error names a byte of the file");
  else if (!error.message.starts_with(name + ": "))
    ClaimNamesLine(error.message, name, content);
}

// Claims about a mesh that was read and whose surface is not yet checked.
void ClaimRaw(const simulation::RawMesh& raw, std::size_t file_bytes) {
  Claim(!raw.triangles.empty(), "a mesh has triangles");
  Claim(raw.triangles.size() <= file_bytes, "a triangle takes a byte of the file and more");
  Claim(raw.part_of_triangle.size() == raw.triangles.size(), "each triangle is of a part");
  for (const std::uint32_t part : raw.part_of_triangle)
    Claim(part < raw.parts.size(), "which is in the list");
  for (const auto& triangle : raw.triangles)
    for (const auto& corner : triangle)
      for (const float x : corner) Claim(std::isfinite(x), "a corner has a place");
}

// Claims that a checked mesh has valid vertices and a closed surface.
void ClaimClosed(const simulation::TriangleMesh& mesh) {
  Claim(!mesh.triangles.empty(), "a shell has triangles");
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t corner : triangle)
      Claim(corner < mesh.vertices_m.size(), "a corner is a vertex");
  for (const Vector3& vertex : mesh.vertices_m)
    Claim(vertex.cwiseAbs().maxCoeff() <= 10.0, "a vertex is within 10 m");
  // each directed edge must have an opposite edge, so that the triangles bound a volume
  std::vector<std::uint64_t> edges;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      edges.push_back(std::uint64_t{t[k]} << 32 | std::uint64_t{t[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  Claim(std::adjacent_find(edges.begin(), edges.end()) == edges.end(), "an edge is walked once each way");
  for (const std::uint64_t edge : edges)
    Claim(std::binary_search(edges.begin(), edges.end(), edge << 32 | edge >> 32),
          "an edge joins two triangles");
}

}  // namespace
}  // namespace osteon::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace osteon;
  static const std::array<fuzz::FuzzFile, 3> files{fuzz::FuzzFile("fuzz.stl"), fuzz::FuzzFile("fuzz.obj"),
                                                   fuzz::FuzzFile("fuzz.ply")};
  fuzz::Input in(data, size);
  const fuzz::FuzzFile& file = files[in.Byte() % files.size()];
  const std::string content = fuzz::Text(in.Rest());
  file.Write(content);
  const auto raw = simulation::ReadMeshFile(file.path());
  if (!raw) {
    fuzz::ClaimError(raw.error(), file.path(), content);
    return 0;
  }
  fuzz::ClaimRaw(*raw, content.size());
  const auto loaded = simulation::LoadMesh(file.path());
  if (!loaded) {
    fuzz::ClaimError(loaded.error(), file.path(), content);
    return 0;
  }
  fuzz::ClaimClosed(loaded->mesh);
  fuzz::Claim(simulation::SignedVolume_m3(loaded->mesh) > 0.0, "a solid encloses something");
  for (const auto& region : loaded->regions) fuzz::ClaimClosed(region.mesh);
  return 0;
}
